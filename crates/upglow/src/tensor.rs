//! Arrays of a safetensors file.

use std::collections::HashMap;

use safetensors::Dtype;
use safetensors::tensor::TensorView;

/// One array of a file.
#[derive(Clone, Debug)]
pub struct Tensor {
    pub(crate) name: &'static str,
    pub(crate) dtype: Dtype,
    pub(crate) shape: Vec<usize>,
    pub(crate) bytes: Vec<u8>,
}

impl Tensor {
    /// Numbers in single precision.
    pub fn singles(
        name: &'static str,
        shape: &[usize],
        values: impl IntoIterator<Item = f32>,
    ) -> Self {
        let bytes = values.into_iter().flat_map(f32::to_le_bytes).collect();
        Self { name, dtype: Dtype::F32, shape: shape.into(), bytes }
    }

    /// Numbers in double precision.
    pub fn doubles<'v>(
        name: &'static str,
        shape: &[usize],
        values: impl IntoIterator<Item = &'v f64>,
    ) -> Self {
        let bytes = values.into_iter().flat_map(|value| value.to_le_bytes()).collect();
        Self { name, dtype: Dtype::F64, shape: shape.into(), bytes }
    }

    /// Bytes as they are.
    #[must_use]
    pub fn bytes(name: &'static str, shape: &[usize], bytes: Vec<u8>) -> Self {
        Self { name, dtype: Dtype::U8, shape: shape.into(), bytes }
    }

    /// The file of some arrays, with one entry of text.
    ///
    /// # Panics
    ///
    /// If an array is not as long as its shape.
    #[must_use]
    pub fn file(tensors: &[Self], entry: &str, text: String) -> Vec<u8> {
        let metadata = HashMap::from([(entry.to_owned(), text)]);
        let views = tensors.iter().map(|tensor| (tensor.name, tensor.view()));
        safetensors::serialize(views, Some(metadata)).expect("names and metadata are plain text")
    }

    fn view(&self) -> TensorView<'_> {
        TensorView::new(self.dtype, self.shape.clone(), &self.bytes)
            .expect("arrays are as long as their shapes")
    }
}
