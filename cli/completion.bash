# Completions of hshfit for bash: source <(hshfit --completion)
_hshfit() {
    local word=${COMP_WORDS[COMP_CWORD]} words=
    if [ "$COMP_CWORD" -eq 1 ]; then
        words="{{#commands}}{{name}} {{/commands}}{{options}}"
    elif [ "${word#-}" != "$word" ]; then
        case ${COMP_WORDS[1]} in
{{#commands}}
            {{name}}) words="{{options}}" ;;
{{/commands}}
        esac
    fi
    mapfile -t COMPREPLY < <(compgen -W "$words" -- "$word")
}
complete -o bashdefault -o default -F _hshfit hshfit
