#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# Tests ./run without touching the machine: a copy of it runs with stand-ins for the tools that it calls.
# Usage: run_test.sh PATH_OF_RUN
set -eu

work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
mkdir "$work/bin"
cp "$1" "$work/run"
echo '{}' >"$work/CMakePresets.json"
for tool in sh dirname cat mkdir rm touch find grep sed awk nproc tr echo printf env; do
  ln -s "$(command -v "$tool" | grep / || echo "/usr/bin/$tool")" "$work/bin/$tool"
done

fail() {
  echo "FAILED: $*" >&2
  cat "$work/output" "$work/calls" >&2
  exit 1
}

# stand_in NAME BODY: a tool that notes how it was called, then does BODY.
stand_in() {
  printf '#!/bin/sh\necho "%s $*" >>"%s/calls"\n%s\n' "$1" "$work" "$2" >"$work/bin/$1"
  chmod +x "$work/bin/$1"
}

# run_it EXPECTED_STATUS ARGS...
run_it() {
  expected=$1
  shift
  : >"$work/calls"
  status=0
  PATH=$work/bin "$work/run" "$@" >"$work/output" 2>&1 || status=$?
  [ "$status" = "$expected" ] || fail "./run $* ended with $status, not $expected"
}
says() { grep -qF -e "$1" "$work/output" || fail "'$1' is not in the output"; }
called() { grep -qF -e "$1" "$work/calls" || fail "'$1' was not called"; }
not_called() { if grep -qF -e "$1" "$work/calls"; then fail "'$1' was called"; fi; }

# shellcheck disable=SC2016 # expanded by the stand-in
all_installed='shift 2; for package in "$@"; do echo "$package installed"; done'
# shellcheck disable=SC2016 # expanded by the stand-in
all_but_exif='shift 2; for package in "$@"; do case $package in libexif-dev) ;; *) echo "$package:amd64 installed" ;; esac; done'
configures="mkdir -p build/release; echo CMAKE_HOME_DIRECTORY:INTERNAL=\$(pwd -P) >build/release/CMakeCache.txt"

# Help and wrong usage need nothing at all.
run_it 0 help
says "./run COMMAND"
run_it 0
run_it 2 nonsense
says "no command 'nonsense'"
run_it 2 bench --json

# Neither Debian nor CMake: the packages are named.
run_it 1 build
says "this is not Debian"
says "libceres-dev"

# One package is missing: it alone is installed, by root directly and by a user through sudo.
stand_in dpkg-query "$all_but_exif"
stand_in apt-get ''
stand_in cmake "$configures"
stand_in id 'echo 0'
run_it 0 build
called "apt-get update"
called "apt-get install -q -y --no-install-recommends libexif-dev"
called "cmake --preset release"
called "cmake --build build/release"
stand_in id 'echo 1000'
run_it 1 build
says "there is no sudo"
says "apt-get install --no-install-recommends libexif-dev"
not_called "apt-get"
stand_in sudo 'exec "$@"'
run_it 0 build
called "sudo apt-get update"
called "install -q -y --no-install-recommends libexif-dev"

# Nothing is missing and nothing has changed: neither apt-get nor the configuration runs.
stand_in dpkg-query "$all_installed"
run_it 0 build
not_called "apt-get"
not_called "cmake --preset"
called "cmake --build build/release"

# The checkout has moved: the old build cannot be used.
echo "CMAKE_HOME_DIRECTORY:INTERNAL=/elsewhere" >"$work/build/release/CMakeCache.txt"
run_it 0 build
called "cmake --preset release"

# What CMake says is shown when it fails.
rm -rf "$work/build"
stand_in cmake 'echo "CMake Error: no such thing"; exit 1'
run_it 1 build
says "CMake Error: no such thing"
says "could not be configured"

echo "./run behaves"
