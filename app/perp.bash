# SPDX-License-Identifier: Apache-2.0
# bash completion for perp, perp-compare and perp-report; installed under each of these names in
# share/bash-completion/completions. Commands, flags and words are those of the programs' own help.

_perp_help() {  # of the command on the line: --help, without its lists of commands and examples
  local words=()
  [ "$command" = help ] || words=("$command")
  "${COMP_WORDS[0]}" "${words[@]}" --help 2>/dev/null
}

_perp_commands() {
  "${COMP_WORDS[0]}" --help 2>/dev/null | awk '/^Subcommands:/ { on = 1; next } !NF { on = 0 } on { print $1 }'
}

_perp_flags() { awk '/^  -/ { sub(/^-.,/, "", $1); print $1 }' <<<"$help"; }

_perp_line() { awk -v flag="$1" '/^  -/ && ("," $1 ",") ~ ("," flag ",")' <<<"$help"; }  # that explains a flag

_perp_problems() {  # names of the collection
  "${COMP_WORDS[0]}" list 2>/dev/null | awk 'NR > 2 && NF == 0 { exit } NR > 2 { print $1 }'
}

_perp_methods() {
  "${COMP_WORDS[0]}" methods 2>/dev/null | awk '/^Options:/ { exit } /^  [a-z0-9-]+( +[(]default[)])?$/ { print $1 }'
}

_perp_keys() {  # of options
  "${COMP_WORDS[0]}" -AMPL -= 2>/dev/null | awk '/^[a-z]/ { print $1 "=" }'
  [ "$command" = contact ] && _perp_line --option | grep -oE '[a-z_]+(,|;|$)' | sed -E 's/[,;]?$/=/'
}

_perp_words() { compgen -W "$1" -- "$cur"; }

_perp_value() {  # of the flag before the cursor, whose line is $1: "  --flag TAKES  what it means"
  local takes=${1#*--} text=${1#*  }
  takes=${takes#* } takes=${takes%%  *} text=${text#*  }
  case $prev in
    --method | --show)
      _perp_words "$(_perp_methods) $([ "$command" = contact ] && echo homotopy nsgs fixed-point extragradient hyperplane alart-curnier fischer-burmeister natural-map tresca panagiotopoulos cadoux)" ;;
    --class)
      _perp_words "$("${COMP_WORDS[0]}" list --json 2>/dev/null | sed -n 's/^ *"class": "\(.*\)",$/\1/p' | sort -u)" ;;
    *)
      case $takes in
        KEY=VALUE*)
          _perp_words "$(_perp_keys)"
          compopt -o nospace 2>/dev/null ;;
        *FILE* | F.mtx*) compgen -f -- "$cur" ;;
        DIR*) compgen -d -- "$cur" ;;
        *'|'*) _perp_words "$(tr '|' ' ' <<<"${takes%% *}")" ;;
        *)
          [[ $text =~ one\ of\ ([^\;.]*) ]] && _perp_words "$(tr -d ',' <<<"${BASH_REMATCH[1]%%: *}")" ;;
      esac ;;
  esac
}

_perp_positional() {
  case $command in
    help) _perp_words "$(_perp_commands)" ;;
    contact)
      _perp_words "$(sed -n 's/^contacts: \(.*\)\.$/\1/p' <<<"$help" | sed 's/,\|$/:/g')"
      compgen -f -X '!*.@(dat|hdf5|h5)' -- "$cur"
      compgen -d -- "$cur" ;;
    *)
      _perp_words "$(_perp_problems)"
      compgen -f -X '!*.@(nl|mtx|dat)' -- "$cur"
      compgen -d -- "$cur" ;;
  esac
}

_perp() {
  local cur=${COMP_WORDS[COMP_CWORD]} prev=${COMP_WORDS[COMP_CWORD-1]} command=${COMP_WORDS[1]} help line
  COMPREPLY=()
  if [ "$COMP_CWORD" -eq 1 ]; then
    mapfile -t COMPREPLY < <(_perp_words "$(_perp_commands) help --help --version -v")
    return
  fi
  help=$(_perp_help)
  line=$(_perp_line "$prev")
  if [[ $line =~ ^\ +-[^\ ]+\ [^\ ] ]]; then  # it takes a value
    mapfile -t COMPREPLY < <(_perp_value "$line")
  elif [ "${cur:0:1}" = - ]; then
    mapfile -t COMPREPLY < <(_perp_words "$(_perp_flags)")
  else
    mapfile -t COMPREPLY < <(_perp_positional)
  fi
}

_perp_list() {  # the words after the last comma of a list, behind what is before it
  local cur=${cur##*,} list=${cur%"${cur##*,}"}
  _perp_words "$1" | sed "s|^|$list|"
  compopt -o nospace 2>/dev/null
}

_perp_lab() {
  local cur=${COMP_WORDS[COMP_CWORD]} prev=${COMP_WORDS[COMP_CWORD-1]} kind=${COMP_WORDS[1]} help
  COMPREPLY=()
  case $kind in contact | facets | ball | forces) ;; *) kind='' ;; esac
  case $prev in
    --problems) mapfile -t COMPREPLY < <(_perp_list "all $(COMP_WORDS=(perp); _perp_problems)") ;;
    --methods) mapfile -t COMPREPLY < <(_perp_list "presets published all none cfunctions $(COMP_WORDS=(perp); _perp_methods)") ;;
    --baseline | --svg | --json | --program) mapfile -t COMPREPLY < <(compgen -f -- "$cur") ;;
    --out) mapfile -t COMPREPLY < <(compgen -d -- "$cur") ;;
    --form) mapfile -t COMPREPLY < <(_perp_words "reduced mixed") ;;
    --*)
      [ "$prev" = --resume ] && mapfile -t COMPREPLY < <(_perp_words "--out") ;;
    *)
      if [ "${cur:0:1}" = - ]; then
        help=$(COLUMNS=1000 "${COMP_WORDS[0]}" $kind --help 2>/dev/null)
        mapfile -t COMPREPLY < <(_perp_words "$(_perp_flags)")
      elif [ "${COMP_WORDS[0]##*/}" = perp-report ]; then
        mapfile -t COMPREPLY < <(compgen -d -- "$cur")
      elif [ "$COMP_CWORD" -eq 1 ]; then
        mapfile -t COMPREPLY < <(_perp_words "contact facets ball forces")
      else
        mapfile -t COMPREPLY < <(compgen -f -- "$cur")
      fi ;;
  esac
}

complete -F _perp perp
complete -F _perp_lab perp-compare perp-report
