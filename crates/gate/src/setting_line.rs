//! On which line of a file a setting stands.

use super::config::line_of;
use rockproof_campaign::config::SettingPlace;
use toml::Spanned;
use toml::de::{DeTable, DeValue};

/// The line, from 1, of a setting in a text; of the table that it would stand in where it is not given. `table` is that of the settings, `None` where they
/// stand in none.
pub fn line_of_setting(text: &str, table: Option<&str>, place: &SettingPlace<'_>) -> usize {
    let Ok(root) = DeTable::parse(text) else { return 1 };
    let within = |name: &str| {
        let found = root.get_ref().get(name)?;
        Some((found.span().start, found.get_ref().as_table()?))
    };
    let (mut start, mut keys) = match table {
        Some(name) => match within(name) {
            Some(found) => found,
            None => return 1,
        },
        None => (0, root.get_ref()),
    };
    if let Some((place, engine)) = place.engine.and_then(|name| engine_of(keys, name)) {
        (start, keys) = (place, engine);
    }
    let value = keys.get(place.key).map(|value| {
        let list = value.get_ref().as_array();
        let is_it = |one: &&Spanned<DeValue<'_>>| place.value.is_some() && one.get_ref().as_str() == place.value;
        list.and_then(|list| list.iter().find(is_it)).unwrap_or(value).span().start
    });
    line_of(text, value.unwrap_or(start))
}

/// A file, with the line of what is wrong in it where that is a setting.
pub fn place_of(file: &str, text: &str, table: Option<&str>, setting: Option<SettingPlace<'_>>) -> String {
    match setting {
        Some(setting) => format!("{file} line {}", line_of_setting(text, table, &setting)),
        None => file.to_owned(),
    }
}

/// The last engine of a name, of which one alone may have it, and where its table begins.
fn engine_of<'k, 't>(keys: &'k DeTable<'t>, name: &str) -> Option<(usize, &'k DeTable<'t>)> {
    let engines = keys.get("external")?.get_ref().as_array()?;
    let mut tables = engines.iter().filter_map(|one| Some((one.span().start, one.get_ref().as_table()?)));
    tables.rfind(|(_, engine)| engine.get("name").and_then(|found| found.get_ref().as_str()) == Some(name))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn line(text: &str, table: Option<&str>, key: &'static str) -> usize {
        line_of_setting(text, table, &SettingPlace { engine: None, key, value: None })
    }

    #[test]
    fn a_key_is_found_in_its_table() {
        let text =
            "corpus = []\n[campaign]\npairs = 3\n\n[baseline]\nfile = \"k\"\n  causes= []\n[[limit]]\nfields = 1\n";
        let lines = [("campaign", "pairs"), ("baseline", "causes"), ("baseline", "fields")];
        assert_eq!(lines.map(|(table, key)| line(text, Some(table), key)), [3, 7, 5]);
        assert_eq!(line("baseline = {}\n", Some("baseline"), "file"), 1);
        assert_eq!(
            (line(text, None, "corpus"), line("\nseed = 1\n", None, "seed"), line("\n", None, "seed")),
            (1, 2, 1)
        );
    }

    #[test]
    fn a_value_is_found_in_its_list_and_a_key_in_the_table_of_its_engine() {
        let text = "[campaign]\nfamilies = [\n  \"sliver\", # \"nope\"\n  \"nope\",\n]\n[[campaign.external]]\nname = \"a\"\ncommand = \"x\"\n\
                    [[campaign.external]]\nname = \"b\"\naccuracy = 9\n[[campaign.external]]\nname = \"a\"\n";
        let line = |engine, key, value| line_of_setting(text, Some("campaign"), &SettingPlace { engine, key, value });
        assert_eq!([line(None, "families", Some("nope")), line(None, "families", Some("other"))], [4, 2]);
        assert_eq!([line(Some("b"), "accuracy", None), line(Some("b"), "timeout_ms", None)], [11, 9]);
        assert_eq!(line(Some("a"), "name", None), 13);
    }
}
