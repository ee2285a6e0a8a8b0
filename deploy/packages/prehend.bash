# Completion for bash: commands and options as the commands' own --help lists them.
_prehend() {
  local word=${COMP_WORDS[COMP_CWORD]} help
  # --help ends every command before it does anything.
  help=$("${COMP_WORDS[@]:0:COMP_CWORD}" --help 2>/dev/null) || help=
  local words
  words=$(sed -nE 's/^ +(-[A-Za-z],)?(--[a-z][a-z-]*).*/\2/p; s/^ {2}([a-z][a-z-]*) {2,}.*/\1/p' <<<"$help")
  mapfile -t COMPREPLY < <(compgen -W "$words" -- "$word"; compgen -f -- "$word")
}
complete -o filenames -F _prehend prehend
