"""Ways in which a TOML file goes wrong, at random."""

import re


def _lines(text):
    return text.splitlines(True)


def _pairs(lines):
    """Numbers of the lines that give a key its value, or begin to."""
    return [i for i, line in enumerate(lines) if re.match(r"[\w.]+ = ", line)]


def delete_line(text, rng):
    lines = _lines(text)
    del lines[rng.choice(_pairs(lines))]
    return "".join(lines)


def delete_section(text, rng):
    lines = _lines(text)
    heads = [i for i, line in enumerate(lines) if line.startswith("[")]
    del lines[rng.choice(heads)]
    return "".join(lines)


def delete_letters(text, rng):
    at = rng.integers(len(text))
    return text[:at] + text[at + rng.integers(1, 9) :]


def change_type(text, rng):
    values = ('"text"', "true", "[]", "{}", "[[1.0]]", "2026-11-22", "3", "[true, 1]", "{type = 1}")
    return _with_value(text, rng, str(rng.choice(values)))


def change_number(text, rng):
    numbers = ("nan", "-inf", "inf", "1e400", "-1e308", "-0.0", "0", str(10**40), "9" * 4400)
    return _with_value(text, rng, str(rng.choice([*numbers, "0x" + "f" * 4000])))


def change_entry(text, rng):
    """Change a number within a list."""
    entries = list(re.finditer(r"(?<=[\[ ])-?\d+\.\d+(?=[,\]])", text))
    if not entries:
        return change_number(text, rng)
    one = entries[rng.integers(len(entries))]
    return text[: one.start()] + str(rng.choice(["nan", "'a'", "[]", "1e999"])) + text[one.end() :]


def rename_key(text, rng):
    lines = _lines(text)
    i = rng.choice(_pairs(lines))
    name = lines[i].partition(" =")[0]
    at = rng.integers(len(name))
    lines[i] = name[:at] + str(rng.choice(list("xyz_"))) + lines[i][at + 1 :]
    return "".join(lines)


def duplicate_key(text, rng):
    lines = _lines(text)
    i = rng.choice(_pairs(lines))
    lines.insert(i, f"{lines[i].partition(' =')[0]} = 1.0\n")
    return "".join(lines)


def rename_type(text, rng):
    names = list(re.finditer(r'(?<=type = ")\w+', text))
    one = names[rng.integers(len(names))]
    return f"{text[: one.start()]}{rng.choice(['Disc', 'Mappd', '', 'os'])}{text[one.end() :]}"


def truncate(text, rng):
    return text[: rng.integers(1, len(text))]


def insert_bytes(text, rng):
    raw = text.encode()
    at = rng.integers(len(raw))
    return raw[:at] + rng.integers(0, 256, rng.integers(1, 5), dtype="u1").tobytes() + raw[at:]


def _with_value(text, rng, value):
    lines = _lines(text)
    i = rng.choice(_pairs(lines))
    lines[i] = f"{lines[i].partition(' =')[0]} = {value}\n"
    return "".join(lines)


MUTATIONS = {
    one.__name__: one
    for one in (
        delete_line,
        delete_section,
        delete_letters,
        change_type,
        change_number,
        change_entry,
        rename_key,
        duplicate_key,
        rename_type,
        truncate,
        insert_bytes,
    )
}


def mutated(text, rng):
    """Return the name of a mutation and the bytes that it has made of a text."""
    name = str(rng.choice(list(MUTATIONS)))
    changed = MUTATIONS[name](text, rng)
    return name, changed if isinstance(changed, bytes) else changed.encode()
