# Completion of marti for fish. The program itself says what fits: marti __complete WORDS.
function __marti_complete
    set -l words (commandline -opc) (commandline -ct)
    set -l word (commandline -ct)
    set -l program (string replace -r '^~' $HOME $words[1])
    for candidate in ($program __complete $words[2..-1] 2>/dev/null)
        switch $candidate
            case ':directories'
                __fish_complete_directories $word ''
            case ':files'
                __fish_complete_path $word
            case ':files *'
                for ending in (string split ' ' -- (string replace ':files ' '' -- $candidate))
                    __fish_complete_suffix $word .$ending
                end
            case '*'
                echo $candidate
        end
    end
end
complete -c marti -f -a '(__marti_complete)'
