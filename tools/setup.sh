# Sourced by tools/demo and tools/test: their common set-up. Expects `root`, the top of the tree.

say() { echo "$program: $*"; }
fail() {
  echo "$program: $*" >&2
  exit 1
}

run_as_root() {
  if [ "$(id -u)" -eq 0 ]; then
    "$@"
  elif command -v sudo >/dev/null; then
    sudo "$@"
  else
    return 1
  fi
}

# LCM needs a route for multicast even when everything stays on this computer.
setup_multicast() {
  ip route get 239.255.76.67 >/dev/null 2>&1 && return 0
  say "multicast has no route: setting it up on the loopback interface until the next reboot"
  if run_as_root ip link set lo up && run_as_root ip route add 224.0.0.0/4 dev lo &&
    ip route get 239.255.76.67 >/dev/null 2>&1; then
    return 0
  fi
  say "could not set up multicast; as root: ip link set lo up && ip route add 224.0.0.0/4 dev lo" >&2
  return 1
}

# build PRESET [TARGET...]: configures, with `configure_options`, and builds; shows the output only if it fails.
configure_options=()
build() {
  local preset=$1 log code=0
  shift
  log=$(mktemp)
  say "building (preset $preset); the first build takes some minutes"
  { cmake --preset "$preset" "${configure_options[@]}" && cmake --build --preset "$preset" ${1:+--target "$@"}; } >"$log" 2>&1 || code=$?
  if [ "$code" -ne 0 ]; then
    grep -nE 'error|FAILED|CMake Error' "$log" | head -40 >&2
    tail -n 30 "$log" >&2
  fi
  rm -f "$log"
  return "$code"
}
