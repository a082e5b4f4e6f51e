#!/bin/sh
# Checks the house rules that a machine can check, over the tracked files. Prints every breach
# as file:line and ends with 1 if there is one; warnings do not count.
set -eu
cd "$(dirname "$0")/.."
for tool in git clang-format shellcheck python3; do
    command -v "$tool" >/dev/null || { echo "house rules: $tool is not installed" >&2; exit 2; }
done
git ls-files --error-unmatch run >/dev/null || exit 2
breaches=$(mktemp)
trap 'rm -f "$breaches"' EXIT

# Reads breaches from standard input and puts them under a heading.
rule() {
    found=$(cat)
    [ -z "$found" ] || printf '%s:\n%s\n' "$1" "$found" >>"$breaches"
}
tracked() { git ls-files -- "$@" | while read -r file; do [ ! -f "$file" ] || echo "$file"; done; }
# matches PATTERN PATHSPEC…: extended regular expression, over tracked files.
matches() {
    pattern=$1
    shift
    git grep -nIE -e "$pattern" -- "$@" || [ $? -eq 1 ]
}

scripts=$(tracked | while read -r file; do
    head -n 1 "$file" 2>/dev/null | grep -aqE '^#!.*[/ ](ba)?sh$' && echo "$file"
done || true)

# clang-format 14 reports nested inline namespaces with --dry-run although it leaves them alone, so
# that its output is compared: of all files at once and, if that differs, of each.
sources=$(mktemp)
trap 'rm -f "$breaches" "$sources"' EXIT
tracked '*.h' '*.cpp' >"$sources"
if [ "$(xargs clang-format <"$sources" | cksum)" != "$(xargs cat <"$sources" | cksum)" ]; then
    while read -r file; do
        clang-format "$file" | cmp -s - "$file" || echo "$file"
    done <"$sources" | rule 'clang-format would change these'
fi
# shellcheck disable=SC2086  # a list of paths without spaces
shellcheck $scripts | rule 'shellcheck' || true

tracked '*.h' '*.cpp' '*.cmake' '*CMakeLists.txt' '*.py' '*.pyi' '*.sh' run .ci/run bench/summary \
    bench/python_eval |
    LC_ALL=C.UTF-8 xargs -r grep -HnE '^.{101,}' | cut -c -80 |
    rule 'lines past 100 columns'
tracked '*.h' '*.cpp' '*.sh' '*.py' run | while read -r file; do
    lines=$(wc -l <"$file")
    [ "$lines" -le 500 ] || echo "$file: $lines lines"
done | rule 'files past 500 lines'
tracked '*.h' | while read -r file; do
    lines=$(wc -l <"$file")
    [ "$lines" -le 120 ] || echo "warning: $file: $lines lines, a header should keep to 120"
done

matches 'file *\( *GLOB' '*.cmake' '*CMakeLists.txt' | rule 'sources are listed, never globbed'
tests/room_graph.py | rule 'rooms of lib: arrows only go down, namespace = folder' || true
version=$(sed -n 's/^project(hshfit VERSION \([0-9.]*\).*/\1/p' CMakeLists.txt)
grep -qF "\"version-semver\": \"$version\"" packaging/vcpkg/vcpkg.json ||
    echo packaging/vcpkg/vcpkg.json | rule "the version is that of CMakeLists.txt, $version"
tests/public_headers.py | rule 'public headers and docs/reference/library.md agree' || true
# shellcheck disable=SC2016  # back-quotes of Markdown
[ "$(sed -n 's/^add_subdirectory(hshfit\/\(.*\))$/\1/p' lib/CMakeLists.txt)" = \
    "$(sed -n 's/^| `\([a-z_/]*\)` | .*/\1/p' docs/project/rooms.md)" ] ||
    echo docs/project/rooms.md | rule 'the page has the rooms of lib/CMakeLists.txt in their order'
# A clause is no subject: "What a fit returns", "How a team runs", or "Where the nodes lie" without
# a comma. `private` has words that hide the field's terms.
openings='(What|Whoever|Which|Whatever|Whichever|How) [^?]*$'
places='Where [^?,]*$'
private='[Ww]hoever|for the sake of|[^t] says? so([ .,;]|$)|in whatever case|with nothing to do'
{
    matches "(^|[.:;] |[*][*]|^[|] *|^[-*] )$openings|$private" '*.md'
    matches "(//[/<!]* |[.:;] )$openings|//[/<!]* $places|//.*($private)" '*.h' '*.cpp'
} | rule 'sentences have a noun for a subject'
subranges='unique|remove(_if)?|search(_n)?|(stable_)?partition|rotate|equal_range|find_end'
matches "ranges::($subranges)\(" '*.h' '*.cpp' |
    rule 'clang 14 does not compile the subranges of libstdc++ 12'
matches '#include *[<"](brdfs|cli|jobs)/' lib | rule 'lib includes nothing from brdfs, jobs or cli'
matches '"([^"]*[^-[:alnum:]"])?--[a-z]|"[^"]*hshfit [a-z]+ ' 'lib/*.cpp' 'lib/*.h' jobs \
    ':!jobs/*_options.*' ':!jobs/common/option_row.h' |
    rule 'options and commands of the program are named in cli and rows of options only (wording.h)'
matches 'hshfit::brdfs|hshfit_brdfs' 'lib/**CMakeLists.txt' | rule 'lib links nothing from brdfs'
matches '#include *[<"](jobs|cli)/' brdfs | rule 'brdfs includes nothing from jobs or cli'
matches '#include *[<"](cli|CLI|python)/' jobs | rule 'jobs includes nothing from cli, nor CLI11'
matches '#include *[<"](cli|CLI)/' python | rule 'python includes nothing from cli, nor CLI11'
# These wrap a library for the rooms above them, or give them a JSON value.
matches '#include *[<"](Eigen|OpenEXR|Imf|Imath|nlohmann)' 'lib/*.h' ':!lib/**/internal/*.h' \
    ':!lib/hshfit/files/json_fields.h' ':!lib/hshfit/files/exr_stream.h' \
    ':!lib/hshfit/pages/pair_summary_json.h' ':!lib/hshfit/pages/picture_error_json.h' \
    ':!lib/hshfit/choice/row_json.h' \
    ':!lib/hshfit/linear_algebra/decompositions.h' |
    rule 'third-party headers stay out of public headers'
# One function makes text printable (files/printable.h): everything printed goes through
# cli/command.cpp (cli/terminal.cpp asks for the width, and the items of a batch write theirs to
# files), everything in JSON through
# files/json_fields.cpp, every page and every script of gnuplot through filledPage. Shaders keep to
# ASCII by themselves.
streams='[^/_[:alnum:]](stderr|stdout|STD(OUT|ERR)_FILENO)|std::(cout|cerr|clog)'
matches "$streams|fmt::print|printf\\(" \
    'lib/*.cpp' 'lib/*.h' brdfs jobs cli ':!cli/command.cpp' ':!cli/terminal.cpp' \
    ':!lib/hshfit/pages/gnuplot.cpp' ':!lib/hshfit/files/standard_streams.cpp' \
    ':!jobs/batches/redirected_streams.cpp' |
    rule 'text is printed by printText, printMessage and note only (cli/command.h)'
# A stream keeps its failures to itself, and a failed allocation is one of them.
git grep -lE 'stringstream|std::ofstream|getline\(' -- lib brdfs jobs cli | while read -r file; do
    grep -qE 'exceptions\(std::ios::badbit\)|\.bad\(\)|if \(!out\)' "$file" || echo "$file"
done | rule 'streams of text throw or are asked whether they failed'
matches '\.dump\(' 'lib/*.cpp' 'lib/*.h' brdfs jobs cli ':!lib/hshfit/files/json_fields.cpp' |
    rule 'JSON becomes text in jsonText only (files/json_fields.h)'
matches '[.]render\(|mustache::mustache' 'lib/*.cpp' brdfs jobs cli \
    ':!lib/hshfit/files/template_text.cpp' |
    rule 'templates are filled by filledPage and filledText only (files/template_text.h)'
matches '/(work|home|Users)/[[:alnum:]]' . | rule 'paths of one machine'
matches '(TEST|TEST_F|TEST_P)\(.*DISABLED_|^ *#if 0' '*.h' '*.cpp' | rule 'switched-off code'
tracked '*.h' '*.cpp' | grep -E '(^|[/_])(utils?|common|helpers?|manager)[_.]' |
    rule 'names that say nothing' || true

# Pages run scripts by their paths.
git ls-files -s | while read -r mode _ _ file; do
    starts=$(head -c 2 "$file" | tr -d '\0')
    case $mode$starts in
        '100644#!') echo "$file: begins with #! and cannot be run (chmod +x)" ;;
        '100755#!') ;;
        100755*) echo "$file: can be run and does not begin with #!" ;;
    esac
done | rule 'scripts that begin with #! can be run, and no other file'

# Markdown ends a table at an empty line: rows below one are text, unless a head and a line of
# dashes come first.
# shellcheck disable=SC2016  # fields of awk
tracked '*.md' | xargs -r awk '
    FNR == 1 { row = ""; before = ""; fenced = 0 }
    row != "" && $0 !~ /^\|[ :-]*-[-| :]*$/ { print row }
    { row = "" }
    /^ *```/ { fenced = !fenced }
    !fenced && /^\| / && before == "" { row = FILENAME ":" FNR ": " substr($0, 1, 60) }
    { before = $0 }' | rule 'rows of a table stand below its head without an empty line'

tracked '*.json' | python3 -c '
import json, sys
for path in sys.stdin.read().split("\n"):
    try:
        if path: json.load(open(path, encoding="utf-8"))
    except ValueError as error:
        print(f"{path}: {error}")' | rule 'JSON that does not parse'

if [ -s "$breaches" ]; then
    cat "$breaches" >&2
    exit 1
fi
echo "house rules: clean, $(git ls-files | wc -l) tracked files"
