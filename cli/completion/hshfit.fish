# Completion of hshfit for fish: hshfit completion fish | source

function __hshfit_complete
    set -l words (commandline -opc) (string trim -l -c "'\"" -- (commandline -ct))
    # An empty token gives an empty list.
    test (count $words) -eq (count (commandline -opc)); and set -a words ''
    set -l reply ($words[1] completion fish -- $words 2>/dev/null)
    string join \n -- $reply[2..-1]
    switch "$reply[1]"
        case '*files*'
            __fish_complete_path $words[-1]
        case '*folders*'
            __fish_complete_directories $words[-1]
    end
end

complete -c hshfit -f -a '(__hshfit_complete)'
