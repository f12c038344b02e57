# A Python with what plots and evaluation need, made on first use. To be sourced after common.sh.

# venv_python [FOLDER]   prints the path of the interpreter; progress goes to stderr. Without a name the folder is build/venv
venv_python() {
  local venv=${1:-$PWD/build/venv} requirements=tools/requirements.txt stamp
  stamp=$venv/installed-$(sha256sum "$requirements" | cut -c1-16)
  mkdir -p "$(dirname "$venv")"
  (
    # Programs that start at the same time wait for the one that makes it.
    exec 9>"$venv.lock"
    ! command -v flock >/dev/null || flock 9
    [ ! -e "$stamp" ] || exit 0
    echo "Making the Python environment for plots in $venv (once; downloads about 150 MB)" >&2
    rm -rf "$venv"
    if ! { python3 -m venv "$venv" &&
      "$venv/bin/pip" install --quiet --disable-pip-version-check -r "$requirements"; } >&2; then
      echo "The Python environment could not be made; no plots." >&2
      exit 1
    fi
    touch "$stamp"
  ) || return 1
  echo "$venv/bin/python"
}
