//! A model folder (`image.onnx`, `text.onnx`, `model.json`) run by ONNX Runtime.

use std::path::{Path, PathBuf};

use image::RgbImage;
use ort::environment::Environment;
use ort::session::Session;
use ort::session::builder::SessionBuilder;
use ort::value::{Outlet, Tensor, TensorElementType};

use super::runtime::environment;
use super::{Embedder, ModelDescription, ModelError, normalised, parse_description, prepare};
use crate::tokenizer::Tokenizer;

/// Files larger than this are no search model; ONNX itself ends at 2 GiB.
const MAX_TOWER_BYTES: u64 = 2 << 30;
const MAX_DESCRIPTION_BYTES: u64 = 1 << 20;
/// Pictures that go through the tower at once: activations of 256² pictures stay below 1 GB.
const IMAGE_BATCH: usize = 8;
/// Texts that go through the tower at once.
const TEXT_BATCH: usize = 32;

/// A model in memory, ready to run.
pub struct OnnxModel {
    description: ModelDescription,
    image: Tower,
    text: Tower,
    tokenizer: Tokenizer,
    image_key: u32,
}

/// One of the two networks.
struct Tower {
    path: PathBuf,
    session: Session,
    input: String,
    output: String,
    dimension: usize,
}

impl OnnxModel {
    /// Opens a model folder, and checks its three files against each other.
    ///
    /// # Errors
    /// [`ModelError`] names the file and the field that do not fit, or says that there is no runtime.
    pub fn open(folder: &Path) -> Result<Self, ModelError> {
        let path = folder.join("model.json");
        let description = parse_description(&path, &read(&path, MAX_DESCRIPTION_BYTES)?)?;
        let side = i64::from(description.image.size);
        let context_length = description.text.context_length as i64;
        let [image_file, text_file] = [
            TowerFile::read(folder.join("image.onnx"), "image", &description.image.crc32),
            TowerFile::read(folder.join("text.onnx"), "text", &description.text.crc32),
        ];
        let (image_file, text_file) = (image_file?, text_file?);
        let image = image_file.open(
            (&description.image.input, TensorElementType::Float32, &[-1, 3, side, side]),
            &description.image.output,
            description.dimension,
        )?;
        let text = text_file.open(
            (&description.text.input, TensorElementType::Int64, &[-1, context_length]),
            &description.text.output,
            description.dimension,
        )?;
        // The release is told first: a tower of another one also has another checksum, and that
        // says less.
        for (tower, role) in [(&image, "image"), (&text, "text")] {
            tower.expect_metadata("release", &description.release)?;
            tower.expect_metadata("tower", role)?;
        }
        image_file.expect_checksum()?;
        text_file.expect_checksum()?;
        let image_key = image_file.crc;
        Ok(Self { description, image, text, tokenizer: Tokenizer::new(), image_key })
    }
}

impl OnnxModel {
    /// Features of pictures that are prepared already ([`prepare`](super::prepare)): n × 3 × size × size
    /// numbers give n features of unit length.
    ///
    /// # Errors
    /// [`ModelError`] when the tower cannot be run.
    ///
    /// # Panics
    /// When the numbers are no whole number of pictures.
    pub fn embed_prepared(&mut self, planes: Vec<f32>) -> Result<Vec<Vec<f32>>, ModelError> {
        let side = self.description.image.size as usize;
        assert!(planes.len().is_multiple_of(3 * side * side));
        let count = planes.len() / (3 * side * side);
        let shape = [count as i64, 3, side as i64, side as i64];
        self.image.run(Tensor::from_array((shape, planes)), count)
    }

    /// Features of texts that are tokens already: n × context_length tokens give n features of unit
    /// length.
    ///
    /// # Errors
    /// [`ModelError`] when the tower cannot be run.
    ///
    /// # Panics
    /// When the tokens are no whole number of texts.
    pub fn embed_tokens(&mut self, tokens: Vec<i64>) -> Result<Vec<Vec<f32>>, ModelError> {
        let length = self.description.text.context_length;
        assert!(tokens.len().is_multiple_of(length));
        let count = tokens.len() / length;
        self.text.run(Tensor::from_array(([count as i64, length as i64], tokens)), count)
    }
}

impl Embedder for OnnxModel {
    fn description(&self) -> &ModelDescription {
        &self.description
    }

    fn image_key(&self) -> u32 {
        self.image_key
    }

    fn embed_images(&mut self, images: &[&RgbImage]) -> Result<Vec<Vec<f32>>, ModelError> {
        let numbers = 3 * (self.description.image.size as usize).pow(2);
        let mut features = Vec::with_capacity(images.len());
        for batch in images.chunks(IMAGE_BATCH) {
            let mut planes = vec![0.0; batch.len() * numbers];
            for (image, planes) in batch.iter().zip(planes.chunks_exact_mut(numbers)) {
                prepare(image, &self.description.image, planes);
            }
            features.extend(self.embed_prepared(planes)?);
        }
        Ok(features)
    }

    fn embed_texts(&mut self, texts: &[String]) -> Result<Vec<Vec<f32>>, ModelError> {
        let length = self.description.text.context_length;
        let mut features = Vec::with_capacity(texts.len());
        for batch in texts.chunks(TEXT_BATCH) {
            let mut tokens = Vec::with_capacity(batch.len() * length);
            for text in batch {
                let words = self.tokenizer.words(text);
                if words.len() > length - 2 {
                    let found = words.len();
                    return Err(ModelError::TextTooLong { expected: length - 2, found });
                }
                tokens.extend(self.tokenizer.framed(&words, length).map(i64::from));
            }
            features.extend(self.embed_tokens(tokens)?);
        }
        Ok(features)
    }
}

/// The bytes of a tower, and what the description says of them.
struct TowerFile {
    path: PathBuf,
    bytes: Vec<u8>,
    role: &'static str,
    crc: u32,
    described: String,
}

impl TowerFile {
    fn read(path: PathBuf, role: &'static str, described: &str) -> Result<Self, ModelError> {
        let bytes = read(&path, MAX_TOWER_BYTES)?;
        let crc = crc32fast::hash(&bytes);
        Ok(Self { path, bytes, role, crc, described: described.to_lowercase() })
    }

    fn expect_checksum(&self) -> Result<(), ModelError> {
        let found = format!("{:08x}", self.crc);
        if found == self.described {
            return Ok(());
        }
        let expected = format!("{} as model.json says in {}.crc32", self.described, self.role);
        Err(ModelError::value(&self.path, "checksum", expected, found))
    }

    /// Loads the network and checks its one input and its output.
    fn open(
        &self,
        (input, element, shape): (&str, TensorElementType, &[i64]),
        output: &str,
        dimension: usize,
    ) -> Result<Tower, ModelError> {
        let refuse = |error: ort::Error| ModelError::tower(&self.path, error);
        let session = session_builder(&environment()?)
            .and_then(|mut builder| builder.commit_from_memory(&self.bytes))
            .map_err(refuse)?;
        let role = self.role;
        let field = format!("input {input}");
        let found = one_of(session.inputs(), input)
            .filter(|_| session.inputs().len() == 1)
            .ok_or_else(|| {
                let expected = format!("the only one, as model.json says in {role}.input");
                ModelError::value(&self.path, &field, expected, names(session.inputs()))
            })?;
        expect_tensor(&self.path, &field, found, element, shape)?;
        let field = format!("output {output}");
        let found = one_of(session.outputs(), output).ok_or_else(|| {
            let expected = format!("as model.json says in {role}.output");
            ModelError::value(&self.path, &field, expected, names(session.outputs()))
        })?;
        let shape = [-1, dimension as i64];
        expect_tensor(&self.path, &field, found, TensorElementType::Float32, &shape)?;
        Ok(Tower {
            path: self.path.clone(),
            session,
            input: input.into(),
            output: output.into(),
            dimension,
        })
    }
}

/// Sessions run on the CPU, and on Apple's systems on what CoreML takes over.
fn session_builder(environment: &Environment) -> ort::Result<SessionBuilder> {
    let builder = Session::builder(environment)?;
    #[cfg(target_vendor = "apple")]
    let builder = builder
        .with_execution_providers([ort::ep::CoreML::default().build()])
        .unwrap_or_else(ort::Error::recover);
    Ok(builder)
}

impl Tower {
    fn expect_metadata(&self, key: &str, expected: &str) -> Result<(), ModelError> {
        let refuse = |error: ort::Error| ModelError::tower(&self.path, error);
        let found = self.session.metadata().map_err(refuse)?.custom(key);
        if found.as_deref() == Some(expected) {
            return Ok(());
        }
        let found = found.unwrap_or_else(|| "nothing".into());
        let expected = format!("{expected:?} as in model.json");
        Err(ModelError::value(&self.path, key, expected, found))
    }

    /// Runs a batch of `count`; the features have unit length.
    fn run<T>(
        &mut self,
        input: ort::Result<Tensor<T>>,
        count: usize,
    ) -> Result<Vec<Vec<f32>>, ModelError>
    where
        T: ort::value::PrimitiveTensorElementType + std::fmt::Debug,
    {
        let refuse = |error: ort::Error| ModelError::tower(&self.path, error);
        let inputs = ort::inputs![self.input.as_str() => input.map_err(refuse)?];
        let outputs = self.session.run(inputs).map_err(refuse)?;
        let value = outputs.get(self.output.as_str()).ok_or_else(|| {
            ModelError::value(&self.path, &self.output, "an output of this run", "none")
        })?;
        let (shape, values) = value.try_extract_tensor::<f32>().map_err(refuse)?;
        if shape[..] != [count as i64, self.dimension as i64] {
            let expected = format!("[{count}, {}]", self.dimension);
            return Err(ModelError::value(&self.path, "output shape", expected, shape));
        }
        values
            .chunks_exact(self.dimension)
            .map(|feature| {
                normalised(feature).ok_or_else(|| {
                    ModelError::value(&self.path, &self.output, "finite features", "NaN or zeros")
                })
            })
            .collect()
    }
}

fn one_of<'a>(outlets: &'a [Outlet], name: &str) -> Option<&'a Outlet> {
    outlets.iter().find(|outlet| outlet.name() == name)
}

fn names(outlets: &[Outlet]) -> String {
    outlets.iter().map(Outlet::name).collect::<Vec<_>>().join(", ")
}

/// Checks type and dimensions; −1 in `shape` has to be free in the graph, any other number may be.
fn expect_tensor(
    path: &Path,
    field: &str,
    outlet: &Outlet,
    element: TensorElementType,
    shape: &[i64],
) -> Result<(), ModelError> {
    let fits = outlet.dtype().tensor_type() == Some(element)
        && outlet.dtype().tensor_shape().is_some_and(|found| {
            found.len() == shape.len()
                && found.iter().zip(shape).all(|(&found, &wanted)| found == wanted || found == -1)
        });
    if fits {
        return Ok(());
    }
    Err(ModelError::value(path, field, format!("{element} {shape:?}"), outlet.dtype()))
}

/// Reads a file of at most `limit` bytes.
fn read(path: &Path, limit: u64) -> Result<Vec<u8>, ModelError> {
    let refuse = |source| ModelError::File { path: path.into(), source };
    let metadata = std::fs::metadata(path).map_err(refuse)?;
    if !metadata.is_file() || metadata.len() > limit {
        let expected = format!("a file of at most {limit} bytes");
        let found = if metadata.is_file() { metadata.len().to_string() } else { "none".into() };
        return Err(ModelError::value(path, "file", expected, found));
    }
    std::fs::read(path).map_err(refuse)
}
