//! What the page of the gallery says is to be done.

/// A command, and what it prints if the page shows that.
pub struct Step {
    pub command: String,
    pub prints: Option<String>,
}

/// A picture that the page shows.
pub struct Picture {
    /// Path below the folder of pictures.
    pub file: String,
    /// Width in pixels; wider ones are shrunk.
    pub width: usize,
}

/// Commands and pictures of the page, in its order.
pub struct Page {
    pub steps: Vec<Step>,
    pub pictures: Vec<Picture>,
}

/// How pictures are named on the page: `<img src="images/gallery/FILE" width="PIXELS" …>`.
const SOURCE: &str = "<img src=\"images/gallery/";

impl Page {
    pub fn read(text: &str) -> Result<Self, String> {
        let mut page = Self { steps: Vec::new(), pictures: Vec::new() };
        let mut lines = text.lines();
        while let Some(line) = lines.next() {
            let block = |lines: &mut std::str::Lines| -> Vec<String> {
                lines.take_while(|l| !l.starts_with("```")).map(str::to_owned).collect()
            };
            match line {
                "```sh" => {
                    let joined = block(&mut lines).join("\n").replace("\\\n", " ");
                    let commands = joined.lines().filter(|l| !l.trim().is_empty());
                    page.steps.extend(commands.map(|c| Step { command: c.into(), prints: None }));
                }
                "```text" => {
                    let step = page.steps.last_mut().ok_or("a block of text before the first command")?;
                    step.prints = Some(block(&mut lines).join("\n"));
                }
                _ => {}
            }
            for (at, _) in line.match_indices(SOURCE) {
                let tag = line[at + SOURCE.len()..].split('>').next().unwrap_or_default();
                let value = |from: &str| from.split('"').next().unwrap_or_default().to_owned();
                let width = tag.split_once("width=\"").map(|(_, rest)| value(rest));
                let width = width.and_then(|w| w.parse().ok()).ok_or_else(|| format!("no width in pixels: {line}"))?;
                page.pictures.push(Picture { file: value(tag), width });
            }
        }
        Ok(page)
    }
}
