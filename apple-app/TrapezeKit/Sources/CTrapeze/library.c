// What the headers declare is in the Rust library; a C target needs a file.
