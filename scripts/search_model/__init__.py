"""What the scripts around text search share: exporting towers, and the bundled model."""
