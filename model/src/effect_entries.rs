//! Entries of `effects:`, whose kind is `cause:` or, as findings of older documents spell it, `label:`.

use std::fmt;

use serde::de::value::MapAccessDeserializer;
use serde::de::{Deserialize, DeserializeSeed, Deserializer, IntoDeserializer, MapAccess, Visitor};
use tribo_sim::Effect;

/// The older name of the key.
const OLDER: &str = "label";
/// Its name.
const NAME: &str = "cause";

/// Reads the list; both keys in one entry are an error, like any key that is there twice.
pub(crate) fn read<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Vec<Effect>, D::Error> {
    let entries = Vec::<Entry>::deserialize(deserializer)?;
    Ok(entries.into_iter().map(|Entry(effect)| effect).collect())
}

struct Entry(Effect);

impl<'de> Deserialize<'de> for Entry {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_map(EntryVisitor)
    }
}

struct EntryVisitor;

impl<'de> Visitor<'de> for EntryVisitor {
    type Value = Entry;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("an effect with its cause")
    }

    fn visit_map<A: MapAccess<'de>>(self, map: A) -> Result<Entry, A::Error> {
        Effect::deserialize(MapAccessDeserializer::new(Renamed(map))).map(Entry)
    }
}

/// A map whose older key has its name.
struct Renamed<A>(A);

impl<'de, A: MapAccess<'de>> MapAccess<'de> for Renamed<A> {
    type Error = A::Error;

    fn next_key_seed<K: DeserializeSeed<'de>>(&mut self, seed: K) -> Result<Option<K::Value>, A::Error> {
        let Some(mut key) = self.0.next_key::<String>()? else { return Ok(None) };
        if key == OLDER {
            NAME.clone_into(&mut key);
        }
        seed.deserialize(key.into_deserializer()).map(Some)
    }

    fn next_value_seed<V: DeserializeSeed<'de>>(&mut self, seed: V) -> Result<V::Value, A::Error> {
        self.0.next_value_seed(seed)
    }
}

#[cfg(test)]
mod tests {
    use tribo_sim::Effect;

    use crate::{ModelFile, YamlDocument, to_yaml};

    fn read(entry: &str) -> Result<ModelFile, String> {
        let text = format!("schema: tribo.model/1\nrobot: panda\neffects:\n- {entry}\n");
        YamlDocument::embedded("m.yaml", &text).parse().map_err(|error| error.to_string())
    }

    #[test]
    fn a_label_is_a_cause_and_is_written_as_one() {
        let [cause, label] = ["cause", "label"]
            .map(|key| read(&format!("{{{key}: coulomb, joint: 2, delta_coulomb_nm: 0.5}}")).unwrap());
        assert_eq!(label.effects, [Effect::Coulomb { joint: 2, delta_coulomb_nm: 0.5 }]);
        assert_eq!(label, cause);
        let written = to_yaml(&label).unwrap();
        assert!(written.contains("cause: coulomb") && !written.contains("label"), "{written}");
    }

    #[test]
    fn both_keys_an_unknown_cause_and_an_unknown_key_are_errors_with_their_line() {
        let twice = read("{label: coulomb, cause: coulomb, joint: 2, delta_coulomb_nm: 0.5}").unwrap_err();
        assert!(twice.contains("duplicate field `cause`"), "{twice}");
        let unknown = read("{label: gremlins, joint: 2}").unwrap_err();
        assert!(unknown.contains("m.yaml:4") && unknown.contains("`gremlins`"), "{unknown}");
        let key = read("{label: coulomb, joint: 2, delta_coulomb_nm: 0.5, colour: 3}").unwrap_err();
        assert!(key.contains("colour"), "{key}");
        let none = read("{joint: 2, delta_coulomb_nm: 0.5}").unwrap_err();
        assert!(none.contains("missing field `cause`"), "{none}");
    }
}
