//! Text in pages.

/// `text` as it stands in HTML or XML, between tags or in quotes; characters that XML cannot hold become U+FFFD.
///
/// ```
/// assert_eq!(rollin::report::escaped("<b> & \"c\""), "&lt;b&gt; &amp; &quot;c&quot;");
/// ```
pub fn escaped(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '<' => out.push_str("&lt;"),
            '>' => out.push_str("&gt;"),
            '&' => out.push_str("&amp;"),
            '"' => out.push_str("&quot;"),
            '\'' => out.push_str("&#39;"),
            '\t' | '\n' => out.push(c),
            '\0'..='\x1f' | '\x7f' | '\u{fffe}' | '\u{ffff}' => out.push('\u{fffd}'),
            c => out.push(c),
        }
    }
    out
}

/// `text` escaped and cut to so many characters, the last of them an ellipsis where something was cut.
pub(super) fn clipped(text: &str, most: usize) -> String {
    if text.chars().count() <= most {
        return escaped(text);
    }
    let cut: String = text.chars().take(most.saturating_sub(1)).collect();
    escaped(&cut) + "…"
}

/// About how wide `text` is, in units of a figure.
pub(super) fn width(text: &str) -> f64 {
    8.8 * text.chars().count() as f64
}
