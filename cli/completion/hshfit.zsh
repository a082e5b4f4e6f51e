#compdef hshfit
# Completion of hshfit for zsh: source <(hshfit completion zsh), or a file _hshfit in a folder of
# $fpath.

_hshfit() {
    local -a reply texts shown behind
    local flags line
    reply=("${(@f)$("$words[1]" completion zsh -- "${(@Q)words[1,CURRENT]}" 2>/dev/null)}")
    flags=$reply[1]
    shift reply
    for line in $reply; do
        texts+=("${line%%$'\t'*}")
        shown+=("${${line/$'\t'/  -- }[1,$COLUMNS - 1]}")
    done
    [[ $flags == *open* ]] && behind=(-S '')
    (( $#texts )) && compadd "${(@)behind}" -l -d shown -a texts
    case $flags in
    *files*) _files ;;
    *folders*) _files -/ ;;
    esac
}

if [[ $funcstack[1] == _hshfit ]]; then
    _hshfit "$@"
else
    compdef _hshfit hshfit
fi
