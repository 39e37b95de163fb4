#!/bin/sh
# Library: lvm-read 1.26 (text files .lvm of LabVIEW)
#
# A file with the header "X_Columns Multi" has a column of times for each channel: time, force, time,
# displacement. Where its line "Channels<tab>2" ends after the number, the reader takes the 2 for the
# number of columns behind the first and leaves out the last one: the displacement is missing, without
# any message. With empty fields behind it, "Channels<tab>2<tab><tab>", the same file is read
# in full: the width of that line decides, not the header's word, nor the line of column names.
# "X_Columns One" is read in full both ways.
set -eu
dir=$(mktemp -d)
trap 'rm -rf "$dir"' EXIT
python3 -m venv "$dir/venv"
"$dir/venv/bin/pip" install -q --disable-pip-version-check lvm-read==1.26 numpy==1.26.4
"$dir/venv/bin/python" - <<'PY'
import lvm_read


def lines(*rows):
    return "".join(row.replace(" ", "\t") + "\n" for row in rows)


HEAD = lines("Writer_Version 2", "Separator Tab", "Decimal_Separator .", "Multi_Headings No")
END = "***End_of_Header***\n"


def read(columns, channels, *rows):
    text = "LabVIEW Measurement\n" + HEAD + lines(f"X_Columns {columns}") + END + "\n"
    text += lines(channels) + END + lines(*rows)
    found = lvm_read.read_str(text)[0]
    return found["Channel names"], found["data"].tolist()


multi = ("X_Value Force X_Value Move Comment", "0.0 1.0 0.05 10.0", "0.1 2.0 0.15 11.0")
one = ("X_Value Force Move Comment", "0.0 1.0 10.0", "0.1 2.0 11.0")
for kind, rows, width in (("Multi", multi, 4), ("One", one, 3)):
    names, data = read(kind, "Channels 2", *rows)
    full_names, full = read(kind, "Channels 2" + " " * (width - 2), *rows)
    print(f"{kind}, 'Channels 2': {names} {data}")
    print(f"{kind}, the same line padded: {full_names} {full}")
    assert [len(row) for row in full] == [width] * 2, "changed: the padded file has all columns"
    lost = 1 if kind == "Multi" else 0
    assert [len(row) for row in data] == [width - lost] * 2, f"changed: {lost} column was lost"
PY
