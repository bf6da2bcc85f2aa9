//! What the table needs to know beside the times.

use std::collections::BTreeMap;

use qsplat::{Error, Result};
use serde_json::{Value, json};

use crate::harness::scratch;

/// Facts by stage and input, kept from run to run so that one stage can be measured anew.
#[derive(Debug, Default)]
pub struct Notes {
    facts: BTreeMap<String, BTreeMap<String, Value>>,
}

/// The file of the notes, in the build folder's `tmp`.
const FILE: &str = "bench-notes.json";

impl Notes {
    /// Notes something of a stage on an input of so many points.
    pub fn add(&mut self, stage: &str, points: usize, fact: Value) {
        self.facts.entry(stage.to_owned()).or_default().insert(points.to_string(), fact);
    }

    /// Notes how many threads work.
    pub fn threads(&mut self, threads: usize) {
        self.facts.entry("machine".to_owned()).or_default().insert("threads".to_owned(), json!(threads));
    }

    /// Notes the graphics adapter.
    #[cfg(feature = "gpu")]
    pub fn adapter(&mut self, name: &str) {
        self.facts.entry("machine".to_owned()).or_default().insert("adapter".to_owned(), json!(name));
    }

    /// Writes the notes over those of earlier runs.
    pub fn save(&self) -> Result<()> {
        let path = scratch(FILE);
        let earlier = std::fs::read(&path).ok();
        let mut all: BTreeMap<String, BTreeMap<String, Value>> =
            earlier.and_then(|bytes| serde_json::from_slice(&bytes).ok()).unwrap_or_default();
        for (stage, facts) in &self.facts {
            all.entry(stage.clone()).or_default().extend(facts.clone());
        }
        let text = serde_json::to_string_pretty(&all)
            .map_err(|error| Error::Internal(format!("the notes cannot be written: {error}")))?;
        std::fs::write(&path, text).map_err(Error::io(&path))
    }
}
