# What the demonstrations have in common; they source it from the top folder.
# shellcheck shell=sh
hshfit=build/hshfit
mkdir -p out

# Runs the program after printing the command line; its answer is in out/answer.txt, too.
show() {
    echo "\$ hshfit $*"
    code=0
    "$hshfit" "$@" >out/answer.txt || code=$?
    cat out/answer.txt
    return $code
}

# number PATTERN [FILE]: the first number in the last answer, or in FILE, that stands at the @.
number() {
    place=$(echo "$1" | sed 's/@/\\([-+0-9.e]*[0-9]\\)/')
    sed -n "s/^\(.*[^-+0-9.e]\)\{0,1\}$place.*/\2/p" "${2:-out/answer.txt}" | head -n 1
}

# holds CLAIM CONDITION: ends the demonstration unless the condition, of awk, is true.
holds() {
    awk "function near(a, b, share) { return a - b <= share * b && b - a <= share * b }
         function within(a, low, high) { return a >= low && a <= high }
         BEGIN { exit !($2) }" 2>/dev/null ||
        { echo "demo: this does not hold: $1: $2" >&2; exit 1; }
    echo "  holds: $1"
}

# finding TEXT COMMAND…: a command that is known to end with exit code 4, and its meaning.
finding() {
    text=$1
    shift
    show "$@" || true
    [ "$code" = 4 ] || { echo "demo: expected exit code 4, not $code" >&2; exit 1; }
    echo "  exit code 4, and rightly so: $text"
}
