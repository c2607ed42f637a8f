"""Tables on the screen; in a pipe they are Markdown."""

from rich.console import Console
from rich.table import Table
from rich.text import Text

from reasoned_explorer.evaluation.bench.tables import Sheet


def print_sheet(console: Console, sheet: Sheet) -> None:
    """Print a table."""
    if not console.is_terminal:
        console.print(sheet.markdown(), markup=False, soft_wrap=True, end="\n\n")
        return
    table = Table(title=Text(sheet.title), title_justify="left", header_style="bold", pad_edge=False)
    for index, name in enumerate(sheet.head):
        table.add_column(Text(name), justify="left" if index < 2 else "right", overflow="fold")
    before = None
    for line in sheet.lines:
        if before is not None and sheet.head[0] == "level" and line[0] != before:
            table.add_section()
        before = line[0]
        table.add_row(*(Text(cell) for cell in line))
    console.print(table)
    for note in sheet.notes:
        console.print(note, markup=False, style="dim")
    console.print()
