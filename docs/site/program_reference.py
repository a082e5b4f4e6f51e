"""Pages that the program writes itself: commands, topics, catalogs, and the schemas of its JSON."""
import json
import subprocess
from pathlib import Path

SCHEMAS = Path(__file__).resolve().parents[1] / "schemas"


def answer(program, *words):
    done = subprocess.run([program, *words], capture_output=True, text=True, check=False,
                          env={"COLUMNS": "90", "PATH": "/usr/bin:/bin"})
    if done.returncode:
        raise SystemExit(f"site: {program} {' '.join(words)}: {done.stderr.strip()}")
    return done.stdout


def fenced(text):
    return f"```text\n{text.rstrip()}\n```\n"


def cell(text):
    return text.replace("|", r"\|").replace("<", r"\<").replace("*", r"\*").replace("\n", " ")


def write_index(folder, title, introduction, rows):
    """A page with a row for each of its pages (name, help), and their order in the sidebar."""
    lines = [f"# {title}", "", introduction, "", "| | |", "|---|---|"]
    lines += [f"| [{name}]({name}.md) | {cell(text)} |" for name, text in rows]
    lines += ["", "```{toctree}", ":hidden:", "", *[name for name, _ in rows], "```", ""]
    (folder / "index.md").write_text("\n".join(lines), encoding="utf-8")


def write_commands(program, folder):
    known = json.loads(answer(program, "help", "--json"))
    for kind, title, introduction in (
            ("commands", "Commands and their options",
             "The help of each command, as the program prints it. [Commands](../commands.md) "
             "describes their answers and files."),
            ("topics", "Topics of the help", "As `hshfit help TOPIC` prints them.")):
        place = folder / kind
        place.mkdir(parents=True)
        for entry in known[kind]:
            name = entry["name"]
            text = f"# {'hshfit ' if kind == 'commands' else ''}{name}\n\n"
            text += fenced(answer(program, "help", name))
            if kind == "commands" and (SCHEMAS / f"{name}.schema.json").exists():
                text += f"\nAnswer of `--json`: [schema](../schemas/{name}.md).\n"
            (place / f"{name}.md").write_text(text, encoding="utf-8")
        write_index(place, title, introduction,
                    [(entry["name"], entry["help"]) for entry in known[kind]])


def write_catalogs(program, folder):
    text = "# Catalogs\n\nThe tables of the program, as `hshfit list` prints them.\n"
    for section in ("models", "formats", "writers", "lights", "bases", "metrics", "targets",
                    "presets"):
        text += f"\n## {section.capitalize()}\n\n" + fenced(answer(program, "list", section))
    (folder / "catalogs.md").write_text(text, encoding="utf-8")


def kind_of(schema):
    """The type of a value in words."""
    if "const" in schema:
        return f"`{json.dumps(schema['const'])}`"
    if "enum" in schema:
        return ", ".join(f"`{json.dumps(value)}`" for value in schema["enum"])
    if "$ref" in schema:
        file, _, part = schema["$ref"].partition("#")
        name = (part or file).rsplit("/", 1)[-1].removesuffix(".schema.json")
        page = f"{file.removesuffix('.schema.json')}.md"
        return f"as [{name}]({page})" if file else f"as `{name}`"
    for word in ("oneOf", "anyOf"):
        if word in schema:
            return " or ".join(dict.fromkeys(kind_of(each) for each in schema[word]))
    kind = schema.get("type", "any")
    kind = " or ".join(kind) if isinstance(kind, list) else kind
    return f"array of {kind_of(schema['items'])}" if kind == "array" and "items" in schema else kind


def rows(schema, path=""):
    """(path, type, description) of every key below an object or an array of objects."""
    required = schema.get("required", [])
    for key, value in schema.get("properties", {}).items():
        where = f"{path}{key}"
        optional = "" if key in required else " (optional)"
        yield where, kind_of(value) + optional, value.get("description", "")
        yield from rows(value, where + ".")
        yield from rows(value.get("items", {}), where + "[].")


def write_schemas(folder):
    place = folder / "schemas"
    place.mkdir(parents=True)
    names = []
    for path in sorted(SCHEMAS.glob("*.schema.json")):
        schema = json.loads(path.read_text(encoding="utf-8"))
        name = path.name.removesuffix(".schema.json")
        title = schema.get("title", name)
        names.append((name, title))
        lines = [f"# {name}", "", f"`{title}`", "", schema.get("description", ""), ""]
        tables = [("", schema)]
        tables += [(key, value) for key, value in schema.get("$defs", {}).items()]
        for heading, part in tables:
            found = list(rows(part))
            if heading:
                lines += [f"## {heading}", "", part.get("description", ""), ""]
                if not found:
                    lines += [kind_of(part), ""]
            if found:
                lines += ["| key | type | meaning |", "|---|---|---|"]
                lines += [f"| `{key}` | {cell(kind)} | {cell(text)} |" for key, kind, text in found]
                lines.append("")
        lines += ["## The schema", "", f"{{download}}`{path.name}`", "",
                  f"```{{literalinclude}} {path.name}\n:language: json\n```", ""]
        (place / f"{name}.md").write_text("\n".join(lines), encoding="utf-8")
        (place / path.name).write_bytes(path.read_bytes())
    write_index(place, "Schemas of the JSON documents",
                "JSON Schema 2020-12 of every document that the program prints or writes. "
                "[Files](../files.md) describes formats and versions.", names)
