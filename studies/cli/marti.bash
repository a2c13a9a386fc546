# Completion of marti for bash. The program itself says what fits: marti __complete WORDS.
_marti() {
  local word candidates directive= prefix words
  COMPREPLY=()
  # Words as the user sees them: bash would cut at '=' and ':'.
  read -ra words <<<"${COMP_LINE:0:COMP_POINT}"
  if [[ ${COMP_LINE:0:COMP_POINT} == *[[:space:]] ]]; then words+=(''); fi
  word=${words[-1]}
  mapfile -t candidates < <("${words[0]/#\~/$HOME}" __complete "${words[@]:1}" 2>/dev/null)
  if [[ ${#candidates[@]} -gt 0 && ${candidates[-1]} == :* ]]; then
    directive=${candidates[-1]}
    unset 'candidates[-1]'
  fi
  COMPREPLY=("${candidates[@]}")
  case $directive in
    :directories) mapfile -t -O "${#COMPREPLY[@]}" COMPREPLY < <(compgen -d -- "$word") ;;
    :files) mapfile -t -O "${#COMPREPLY[@]}" COMPREPLY < <(compgen -f -- "$word") ;;
    :files\ *)
      local ending
      for ending in ${directive#:files }; do
        mapfile -t -O "${#COMPREPLY[@]}" COMPREPLY < <(compgen -f -X "!*.$ending" -- "$word")
      done
      mapfile -t -O "${#COMPREPLY[@]}" COMPREPLY < <(compgen -d -- "$word")
      ;;
  esac
  if [[ -n $directive ]]; then compopt -o filenames 2>/dev/null; fi
  if [[ ${#COMPREPLY[@]} -gt 0 && ${COMPREPLY[0]} == *= ]]; then compopt -o nospace 2>/dev/null; fi
  # What bash takes for earlier words is there already.
  prefix=${word%"${word##*[=:]}"}
  if [[ -n $prefix && $COMP_WORDBREAKS == *["${prefix: -1}"]* ]]; then
    COMPREPLY=("${COMPREPLY[@]#"$prefix"}")
  fi
}
complete -F _marti marti
