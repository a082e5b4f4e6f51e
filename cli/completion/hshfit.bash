# Completion of hshfit for bash: source <(hshfit completion bash)
# shellcheck shell=bash

# The words of the line up to the cursor. COMP_WORDS has them cut at every character of
# COMP_WORDBREAKS, such as ':' and '='; pieces without a space between them are one word.
_hshfit_words() {
    local rest=${COMP_LINE:0:COMP_POINT} piece bare
    words=()
    for piece in "${COMP_WORDS[@]:0:COMP_CWORD+1}"; do
        bare=${rest#"${rest%%[![:space:]]*}"}
        if [[ ${#words[@]} -eq 0 || $bare != "$rest" ]]; then
            words+=("")
        fi
        piece=${piece:0:${#bare}}
        words[${#words[@]}-1]+=$piece
        rest=${bare#"$piece"}
    done
    words=("${words[@]//[\"\']/}")
}

_hshfit() {
    local words reply flags typed piece strip k file
    _hshfit_words
    typed=${words[${#words[@]}-1]}
    mapfile -t reply < <("${COMP_WORDS[0]}" completion bash -- "${words[@]}" 2>/dev/null)
    flags=${reply[0]}
    reply=("${reply[@]:1}")
    if [[ ${#reply[@]} -eq 0 ]]; then
        case $flags in
        *files*) ;;
        *folders*) compopt -o dirnames ;;
        *) compopt +o default +o bashdefault ;;
        esac
        return
    fi
    if [[ $flags == *files* && -n $typed ]]; then
        while IFS= read -r file; do
            [[ -d $file ]] && file+=/
            reply+=("$file")
        done < <(compgen -f -- "$typed")
    fi
    # bash replaces the last piece only, which is a single ':' or '=' if nothing follows that.
    piece=${COMP_WORDS[COMP_CWORD]}
    [[ $piece == [:=] ]] && piece=
    strip=$((${#typed} - ${#piece}))
    [[ $strip -lt 0 ]] && strip=0
    COMPREPLY=()
    for k in "${reply[@]}"; do
        COMPREPLY+=("${k:strip}")
    done
    if [[ $flags == *open* || ${#COMPREPLY[@]} -eq 1 && ${COMPREPLY[0]} == *[:=/] ]]; then
        compopt -o nospace
    fi
}
complete -o bashdefault -o default -F _hshfit hshfit
