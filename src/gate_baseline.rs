//! The file of a gate's baseline.

use anyhow::Context;
use rockproof_gate::config::Baseline;
use rockproof_gate::known_findings::KnownFindings;
use rockproof_gate::toml_error::toml_error;
use rockproof_model::files::read_text;

/// What is known, from the baseline's file.
pub(crate) fn load(baseline: &Baseline) -> anyhow::Result<KnownFindings> {
    let file = baseline.file.display();
    let text = read_text(&baseline.file).with_context(|| match baseline.file.exists() {
        true => file.to_string(),
        false => format!("{file}: no baseline; --update-baseline writes it"),
    })?;
    let wrong = |error: toml::de::Error| anyhow::Error::msg(toml_error(&file.to_string(), &text, &error));
    let known: KnownFindings = toml::from_str(&text).map_err(wrong)?;
    if known.fields != baseline.fields {
        let fields = (known.fields.join(", "), baseline.fields.join(", "));
        anyhow::bail!(
            "{file}: its fields are {}; the gate's are {}; --update-baseline writes it anew",
            fields.0,
            fields.1
        );
    }
    if let Some(why) = known.impossible() {
        anyhow::bail!("{file}: {why}; --update-baseline writes it anew");
    }
    Ok(known)
}

/// Refuses to write a baseline anew over a file that is none.
pub(crate) fn is_baseline(baseline: &Baseline) -> anyhow::Result<()> {
    let file = baseline.file.display();
    match read_text(&baseline.file) {
        Err(error) if error.kind() == std::io::ErrorKind::NotFound => Ok(()),
        Err(error) => Err(error).with_context(|| file.to_string()),
        Ok(text) => toml::from_str::<KnownFindings>(&text).map(drop).map_err(|error| {
            let why = toml_error(&file.to_string(), &text, &error);
            anyhow::anyhow!("{why}: {file} is no baseline, so --update-baseline leaves it alone")
        }),
    }
}
