# bash completion for perp; installed as share/bash-completion/completions/perp.

_perp_keys() {  # the option keys, from the program itself
  "$1" -AMPL -= 2>/dev/null | awk '/^[a-z]/ { print $1 "=" }'
}

_perp_methods() {
  "$1" methods 2>/dev/null | awk '/^Options:/ { exit } /^  [a-z]/ && !/[(]/ || /[(]default[)]/ { print $1 }'
}

_perp_problems() {  # names of the collection
  "$1" list 2>/dev/null | awk 'NR > 2 && NF == 0 { exit } NR > 2 { print $1 }'
}

_perp() {
  local cur=${COMP_WORDS[COMP_CWORD]} prev=${COMP_WORDS[COMP_CWORD-1]} command=${COMP_WORDS[1]}
  COMPREPLY=()
  if [ "$COMP_CWORD" -eq 1 ]; then
    mapfile -t COMPREPLY < <(compgen -W 'solve inspect list export methods cfunctions compare report contact help --help --version -v' -- "$cur")
    return
  fi
  case $prev in
    --formulation)
      mapfile -t COMPREPLY < <(compgen -W 'glocker ncp1 inner:8 outer:8 frictionless' -- "$cur")
      return ;;
    --encoding)
      mapfile -t COMPREPLY < <(compgen -W 'A B' -- "$cur")
      return ;;
    --row)
      mapfile -t COMPREPLY < <(compgen -W 'normalised original' -- "$cur")
      return ;;
    --form)
      mapfile -t COMPREPLY < <(compgen -W 'reduced mixed' -- "$cur")
      return ;;
    --fclib-out | --svg)
      mapfile -t COMPREPLY < <(compgen -f -- "$cur")
      return ;;
    --method | --show)
      local more=
      [ "$command" = contact ] && more=homotopy
      mapfile -t COMPREPLY < <(compgen -W "$(_perp_methods "${COMP_WORDS[0]}") $more" -- "$cur")
      return ;;
    --log-level)
      mapfile -t COMPREPLY < <(compgen -W 'quiet warning summary info debug' -- "$cur")
      return ;;
    --class)
      mapfile -t COMPREPLY < <(compgen -W "$("${COMP_WORDS[0]}" list --json 2>/dev/null |
        sed -n 's/^ *"class": "\(.*\)",$/\1/p' | sort -u)" -- "$cur")
      return ;;
    -o | --output)
      if [ "$command" = export ]; then
        mapfile -t COMPREPLY < <(compgen -f -- "$cur")
        return
      fi ;;&
    -o | --option)
      if [ "$command" = contact ]; then
        mapfile -t COMPREPLY < <(compgen -W "$(_perp_keys "${COMP_WORDS[0]}") sweeps= polish= polish_at= other_settings= proximal= scaling=
          delta_share= eps_share= least_centring= to_boundary= neighbourhood= delta= eps= stages=" -- "$cur")
        compopt -o nospace
        return
      fi
      mapfile -t COMPREPLY < <(compgen -W "$(_perp_keys "${COMP_WORDS[0]}")" -- "$cur")
      compopt -o nospace
      return ;;
    --options-file)
      mapfile -t COMPREPLY < <(compgen -f -- "$cur")
      return ;;
    --json)
      if [ "$command" = solve ] || [ "$command" = inspect ] || [ "$command" = contact ]; then
        mapfile -t COMPREPLY < <(compgen -f -- "$cur")
        return
      fi ;;
    --lower | --upper | --start-at | --solution | --warm-start | --plot)
      mapfile -t COMPREPLY < <(compgen -f -- "$cur")
      return ;;
    --out)
      mapfile -t COMPREPLY < <(compgen -d -- "$cur")
      return ;;
    --baseline)
      mapfile -t COMPREPLY < <(compgen -f -X '!*.csv' -- "$cur"; compgen -d -- "$cur")
      return ;;
    --problems)
      mapfile -t COMPREPLY < <(compgen -W "all $(_perp_problems "${COMP_WORDS[0]}")" -- "$cur")
      return ;;
    --methods)
      mapfile -t COMPREPLY < <(compgen -W 'presets published all cfunctions none' -- "$cur")
      return ;;
    --start | --plot-iteration | --tol | --tol-relative | --max-iterations | --time-limit)
      return ;;
  esac
  case $command in
    solve)
      if [ "${cur:0:1}" = - ]; then
        mapfile -t COMPREPLY < <(compgen -W '--start --start-at --warm-start --lower --upper --solution --method --all --tol --tol-relative --max-iterations --time-limit --check-derivatives --verify
          --option --options-file --json --plot --plot-iteration --log-level --full --help' -- "$cur")
      else
        mapfile -t COMPREPLY < <(compgen -W "$(_perp_problems "${COMP_WORDS[0]}")" -- "$cur"
          compgen -f -X '!*.@(nl|mtx|dat)' -- "$cur"; compgen -d -- "$cur")
      fi ;;
    inspect)
      if [ "${cur:0:1}" = - ]; then
        mapfile -t COMPREPLY < <(compgen -W '--start --start-at --lower --upper --json --help' -- "$cur")
      else
        mapfile -t COMPREPLY < <(compgen -W "$(_perp_problems "${COMP_WORDS[0]}")" -- "$cur"
          compgen -f -X '!*.@(nl|mtx|dat)' -- "$cur"; compgen -d -- "$cur")
      fi ;;
    list)
      if [ "${cur:0:1}" = - ]; then
        mapfile -t COMPREPLY < <(compgen -W '--class --json --help' -- "$cur")
      else
        mapfile -t COMPREPLY < <(compgen -W "$(_perp_problems "${COMP_WORDS[0]}")" -- "$cur")
      fi ;;
    compare)
      mapfile -t COMPREPLY < <(compgen -W '--problems --methods --starts --tol --time-limit --memory-limit --jobs --restarts --seed --external
        --out --resume --baseline --help' -- "$cur") ;;
    contact)
      if [ "${COMP_WORDS[2]}" = ball ] && [ "$COMP_CWORD" -gt 2 ]; then
        mapfile -t COMPREPLY < <(compgen -W '--facets --exact --outer --load --frame --mu --phase --cycles --step --theta --rolling --svg
          --json --help' -- "$cur")
      elif [ "${cur:0:1}" = - ]; then
        mapfile -t COMPREPLY < <(compgen -W '--generate --formulation --method --option --encoding --row --form --tol --time-limit --json --fclib-out --svg
          --log-level --full --compare --variants --out --resume --memory-limit --jobs --facets --help' -- "$cur")
      else
        mapfile -t COMPREPLY < <(compgen -W 'ball stack: spheres: arch: chain: wall: incline:' -- "$cur"
          compgen -f -X '!*.@(dat|hdf5|h5)' -- "$cur"; compgen -d -- "$cur")
      fi ;;
    report) mapfile -t COMPREPLY < <(compgen -d -- "$cur") ;;
    export)
      if [ "${cur:0:1}" = - ]; then
        mapfile -t COMPREPLY < <(compgen -W '--output --start --force --help' -- "$cur")
      else
        mapfile -t COMPREPLY < <(compgen -W "$(_perp_problems "${COMP_WORDS[0]}")" -- "$cur")
      fi ;;
    methods) mapfile -t COMPREPLY < <(compgen -W '--show --help' -- "$cur") ;;
    cfunctions) mapfile -t COMPREPLY < <(compgen -W '--help' -- "$cur") ;;
    help) mapfile -t COMPREPLY < <(compgen -W 'solve inspect list export methods cfunctions compare report contact' -- "$cur") ;;
  esac
}

complete -F _perp perp
