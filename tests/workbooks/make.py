"""Makes the workbooks of this folder, with openpyxl and odfpy: python3 tests/workbooks/make.py

consist.xlsx, consist.ods and consist.csv hold the same train. The workbooks have what workbooks have: a title above the header, a
grade shown as a percentage, a note on a cell, a date in a column that is not read, sheets beside the table, empty cells that are
repeated to the end.
"""

import datetime
import os
import zipfile

import openpyxl
from odf import office, table as odf_table, text as odf_text
from odf.opendocument import OpenDocumentSpreadsheet
from openpyxl.comments import Comment

os.chdir(os.path.dirname(os.path.abspath(__file__)))
HEADER = ["Pos", "Label", "Mass (t)", "Length [m]", "Grade [%]", "Rated load", "Stiffness [MN/m]", "Loaded on"]
DAY = datetime.date(2026, 11, 3)
ROWS = [
    [1, "locomotive", 195, 22.4, 0.012, "1.5 MN", 30, DAY],
    [2, 'car, "long"', 81.125, 18.5, 0.07, "1.2 MN", None, DAY],
    [3, "car & tank", 94.3, 18.5, 0.012, None, 22.5, None],
    [4, "car", 94.3, 18.5, 0, None, None, DAY],
]


def xlsx(name, rows, sheets=("Notes", "Consist"), header=HEADER):
    book = openpyxl.Workbook()
    notes = book.active
    notes.title = sheets[0]
    notes["B2"] = "mass of the cars as weighed"
    for title in sheets[1:]:
        sheet = book.create_sheet(title)
        sheet["A1"] = "Train 4711"
        for j, heading in enumerate(header):
            sheet.cell(3, j + 1, heading)
        for i, row in enumerate(rows):
            for j, value in enumerate(row):
                cell = sheet.cell(4 + i, j + 1, value)
                if header[j].startswith("Grade"):
                    cell.number_format = "0.0%"
        sheet["C4"].comment = Comment("with fuel 200 t", "")
    book.properties.created = book.properties.modified = datetime.datetime(2026, 11, 3)
    book.save(name)


def ods(name, rows):
    book = OpenDocumentSpreadsheet()
    notes = odf_table.Table(name="Notes")
    book.spreadsheet.addElement(notes)
    sheet = odf_table.Table(name="Consist")
    for row in [["Train 4711"], [], HEADER, *rows]:
        line = odf_table.TableRow()
        for heading, value in zip(HEADER, row):
            if value is None:
                cell = odf_table.TableCell()
            elif isinstance(value, datetime.date):
                cell = odf_table.TableCell(valuetype="date", datevalue=value.isoformat())
                cell.addElement(odf_text.P(text=value.strftime("%d.%m.%Y")))
            elif isinstance(value, str):
                cell = odf_table.TableCell(valuetype="string")
                cell.addElement(odf_text.P(text=value))
            else:
                kind = "percentage" if heading.startswith("Grade") else "float"
                cell = odf_table.TableCell(valuetype=kind, value=value)
                if value == 195:
                    note = office.Annotation()
                    note.addElement(odf_text.P(text="with fuel 200 t"))
                    cell.addElement(note)
                cell.addElement(odf_text.P(text=str(value)))
            line.addElement(cell)
        line.addElement(odf_table.TableCell(numbercolumnsrepeated=16376))
        sheet.addElement(line)
    rest = odf_table.TableRow(numberrowsrepeated=1048569)
    rest.addElement(odf_table.TableCell(numbercolumnsrepeated=16384))
    sheet.addElement(rest)
    book.spreadsheet.addElement(sheet)
    book.save(name)


def content(name, body):
    """An ods with this table alone."""
    names = ("office", "table", "text")
    spaces = " ".join(f'xmlns:{n}="urn:oasis:names:tc:opendocument:xmlns:{n}:1.0"' for n in names)
    xml = f'<office:document-content {spaces}><office:body><office:spreadsheet><table:table table:name="A">'
    with zipfile.ZipFile(name, "w", zipfile.ZIP_DEFLATED) as book:
        book.writestr("mimetype", "application/vnd.oasis.opendocument.spreadsheet", zipfile.ZIP_STORED)
        book.writestr("content.xml", xml + body + "</table:table></office:spreadsheet></office:body></office:document-content>")


xlsx("consist.xlsx", ROWS)
xlsx("two-tables.xlsx", ROWS, ("Notes", "Winter", "Summer"))
xlsx("bad-cells.xlsx", [ROWS[0], [2, "car", DAY, 18.5, 0, None, None, None], [3, "car", "=1/0", 1, 0, None, None, None]])
ods("consist.ods", ROWS)
cell = '<table:table-cell office:value-type="float" office:value="1" table:number-columns-repeated="16384"/>'
content("repeated.ods", f'<table:table-row table:number-rows-repeated="1048576">{cell}</table:table-row>')
with open("consist.csv", "w", encoding="utf-8", newline="") as file:
    file.write("Train 4711;;;;;;;\n\n" + ";".join(HEADER) + "\n")
    file.write('1;locomotive;195;22,4;1,2;1,5 MN;30;03.11.2026\n2;"car, ""long""";81,1250;18,5;7;1,2 MN;;03.11.2026\n')
    file.write("3;car & tank;94,3;18,5;1,2;;22,5;\n4;car;94,3;18,5;0;;;03.11.2026\n")
