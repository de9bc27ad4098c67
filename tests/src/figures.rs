//! `figures`: every figure and table of the papers, made anew.

use crate::{
    program::{Outcome, Run},
    report::{Cell, Header, Page, shown_png, svg},
    technique::{Block, Failure, Figure},
};
use serde::Serialize;

/// The file `report.json`.
#[derive(Debug, Serialize)]
struct Report {
    #[serde(flatten)]
    header: Header,
    figures: Vec<FigureRow>,
}

/// What became of a figure.
#[derive(Debug, Serialize)]
struct FigureRow {
    technique: &'static str,
    figure: &'static str,
    title: &'static str,
    failure: Option<String>,
}

pub(crate) fn run(run: &mut Run<'_>) -> Result<Outcome, Failure> {
    let scope = run.context.scope().clone();
    let mut planned: Vec<(&'static str, Figure)> = Vec::new();
    for technique in &run.techniques {
        planned.extend((technique.figures)(&scope).into_iter().map(|figure| (technique.name, figure)));
    }
    run.check_scene(&planned.iter().map(|(_, figure)| figure.name.to_owned()).collect::<Vec<_>>())?;
    planned.retain(|(_, figure)| run.wants(figure.name));
    run.progress.set_steps(planned.len());
    let mut made: Vec<(FigureRow, Figure, Vec<Block>)> = Vec::new();
    for (technique, figure) in planned {
        if run.context.is_stopped() {
            break;
        }
        run.progress.begin(&format!("{technique}: {}", figure.title));
        let blocks = run.guard(|context| (figure.make)(context));
        run.progress.advance(1);
        if run.context.is_stopped() {
            break;
        }
        let (blocks, failure) = match blocks {
            Ok(blocks) => (blocks, None),
            Err(error) => (Vec::new(), Some(error)),
        };
        made.push((
            FigureRow { technique, figure: figure.name, title: figure.title, failure },
            figure,
            blocks,
        ));
    }
    let mut header = run.header.clone();
    header.interrupted = run.context.is_stopped();
    let page = page(&header, &mut made);
    let figures: Vec<FigureRow> = made.into_iter().map(|(row, ..)| row).collect();
    let complaints: Vec<String> = figures.iter().filter_map(FigureRow::complaint).collect();
    let count = figures.len();
    run.write("report.json", &Report { header, figures }, page)?;
    if complaints.is_empty() {
        Ok(Outcome::Passed(format!("{count} figures")))
    } else {
        Ok(Outcome::Failed(complaints))
    }
}

impl FigureRow {
    fn complaint(&self) -> Option<String> {
        self.failure.as_ref().map(|failure| format!("{} {}: {failure}", self.technique, self.figure))
    }
}

/// The page. A picture or a plot that cannot be encoded becomes its figure's failure.
fn page(header: &Header, made: &mut [(FigureRow, Figure, Vec<Block>)]) -> Page {
    let mut page = Page::new("Sheen: figures", header);
    let links: Vec<(String, String)> =
        made.iter().map(|(row, ..)| (row.title.to_owned(), link(row))).collect();
    page.links(&links);
    for (row, figure, blocks) in made {
        page.heading(2, row.title, &link(row));
        page.paragraph(figure.caption);
        for block in blocks {
            if let Err(error) = show(&mut page, block) {
                row.failure.get_or_insert_with(|| error.to_string());
            }
        }
        if let Some(complaint) = row.complaint() {
            page.bad(&complaint);
        }
    }
    page
}

fn link(row: &FigureRow) -> String {
    format!("{}-{}", row.technique, row.figure)
}

fn show(page: &mut Page, block: &Block) -> Result<(), Failure> {
    match block {
        Block::Text(text) => page.paragraph(text),
        Block::Plot(plot) => page.plot(&svg(plot)?),
        Block::Table { head, rows } => {
            let cell = |text: &String| match text.parse::<f64>() {
                Ok(_) => Cell::Number(text.clone()),
                Err(_) => Cell::text(text),
            };
            let rows: Vec<Vec<Cell>> = rows.iter().map(|row| row.iter().map(cell).collect()).collect();
            page.table(&head.iter().map(String::as_str).collect::<Vec<_>>(), &rows, |_| false);
        }
        Block::Pictures(pictures) => {
            let encoded: Vec<(Vec<u8>, [usize; 2], String)> = pictures
                .iter()
                .map(|labelled| {
                    shown_png(&labelled.picture).map(|(png, size)| (png, size, labelled.label.clone()))
                })
                .collect::<Result<_, _>>()?;
            page.pictures(&encoded);
        }
    }
    Ok(())
}
