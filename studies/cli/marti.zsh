#compdef marti
# Completion of marti for zsh. The program itself says what fits: marti __complete WORDS.
_marti() {
  local directive= ending
  local -a candidates open closed
  candidates=("${(@f)$("${words[1]/#\~/$HOME}" __complete "${(@)words[2,CURRENT]}" 2>/dev/null)}")
  if [[ ${candidates[-1]} == :* ]]; then
    directive=${candidates[-1]}
    candidates[-1]=()
  fi
  open=(${(M)candidates:#*=})
  closed=(${candidates:#*=})
  compadd -S '' -- $open
  compadd -- $closed
  case $directive in
    :directories) _files -/ ;;
    :files) _files ;;
    :files\ *) _files -g "*.(${${directive#:files }// /|})" ;;
  esac
}
if [ "$funcstack[1]" = "_marti" ]; then _marti "$@"; else compdef _marti marti; fi
