//! Messages as bytes, through the serialisation of the DDS library.

use rustdds::RepresentationIdentifier;
use rustdds::bytes::Bytes;
use rustdds::no_key::{Decode, DefaultDecoder, DeserializerAdapter, SerializerAdapter};

/// One message in CDR with the four bytes in front that say its byte order.
#[derive(Clone, Debug)]
pub(crate) struct Raw(pub Vec<u8>);

/// Passes bytes on.
pub(crate) struct RawAdapter;

/// Length of what stands in front.
const ENCAPSULATION: usize = 4;

/// Never happens.
#[derive(Clone, Copy, Debug, thiserror::Error)]
#[error("bytes are always bytes")]
pub(crate) struct NeverWrong;

impl DeserializerAdapter<Raw> for RawAdapter {
    type Error = NeverWrong;
    type Decoded = Raw;

    fn supported_encodings() -> &'static [RepresentationIdentifier] {
        &[RepresentationIdentifier::CDR_LE, RepresentationIdentifier::CDR_BE]
    }

    fn transform_decoded(decoded: Raw) -> Raw {
        decoded
    }
}

#[derive(Clone)]
pub(crate) struct RawDecoder;

impl Decode<'_, Raw> for RawDecoder {
    type Error = NeverWrong;

    fn decode_bytes(self, fields: &[u8], encoding: RepresentationIdentifier) -> Result<Raw, NeverWrong> {
        let little = u8::from(encoding != RepresentationIdentifier::CDR_BE);
        let mut message = Vec::with_capacity(ENCAPSULATION + fields.len());
        message.extend_from_slice(&[0, little, 0, 0]);
        message.extend_from_slice(fields);
        Ok(Raw(message))
    }
}

impl DefaultDecoder<Raw> for RawAdapter {
    type Decoder = RawDecoder;
    const DECODER: RawDecoder = RawDecoder;
}

impl SerializerAdapter<Raw> for RawAdapter {
    type Error = NeverWrong;

    fn output_encoding() -> RepresentationIdentifier {
        RepresentationIdentifier::CDR_LE
    }

    fn to_bytes(message: &Raw) -> Result<Bytes, NeverWrong> {
        Ok(Bytes::copy_from_slice(message.0.get(ENCAPSULATION..).unwrap_or_default()))
    }
}
