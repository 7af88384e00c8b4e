#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# Runs README's commands on a bare machine: a minimal Debian with Python, venv, git and a clone of this commit.
# The script needs root privileges and the Debian package mmdebstrap.
# usage: tools/bare.sh [--all] [--keep FOLDER] [--copy PATH]...
#   --all          also run every test, build eonlib's archive, and install the package with pip
#   --keep FOLDER  install the machine in FOLDER, or reuse the machine in FOLDER
#   --copy PATH    copy PATH to the machine, such as pip's configuration, certificates or wheels
set -eu
top=$(cd "$(dirname "$0")/.." && pwd)
root="" all="" copies=""
options() {
    while [ $# -gt 0 ]; do
        case $1 in
        --all) all=yes ;;
        --keep) mkdir -p "$2"; root=$(cd "$2" && pwd); shift ;;
        --copy) copies="$copies $2"; shift ;;
        *) sed -n 's/^# usage/usage/p; s/^#   -/  -/p' "$0" >&2; exit 2 ;;
        esac
        shift
    done
}
options "$@"

# Print the commands to run on the machine. --all adds commands to the first block of README.
commands() {
    sed -n '/^```sh$/,/^```$/p' "$top/README.md" | sed '1d; /^```$/,$d'
    [ -z "$all" ] || cat <<'END'
./run test --all
./run library
deactivate
python3 -m venv /tmp/user
/tmp/user/bin/pip install --quiet '.[report]'
cd /tmp
/tmp/user/bin/mxeon check --host gl
END
}

if [ "${MXEON_BARE:-}" ]; then
    # This process has own namespaces, so all mounts and child processes end with this process.
    cd "$MXEON_BARE"
    mount -t proc proc proc
    mount --rbind /sys sys
    mount --rbind /dev dev
    for name in $(env | sed -n 's/^\([A-Za-z_][A-Za-z_0-9]*\)=.*/\1/p'); do
        case $name in PIP_* | SSL_* | NODE_* | npm_config_* | *_proxy | *_PROXY) ;; *) unset "$name" ;; esac
    done
    HOME=/root PATH=/usr/sbin:/usr/bin:/sbin:/bin exec chroot . sh -c 'cd /mxeon && exec sh -ev /commands'
fi

[ -n "$root" ] || { root=$(mktemp -d) && trap 'rm -rf --one-file-system "$root"' EXIT; }
[ -e "$root/etc/debian_version" ] || mmdebstrap --quiet --variant=minbase \
    --include=ca-certificates,git,python3,python3-venv bookworm "$root"
for path in /etc/hosts /etc/resolv.conf $copies; do
    mkdir -p "$root$(dirname "$path")"
    cp -rL "$path" "$root$(dirname "$path")"
done
rm -rf "$root/mxeon"
git clone -q --no-local "$top" "$root/mxeon"
git -C "$root/mxeon" checkout -q --detach "$(git -C "$top" rev-parse HEAD)"
commands >"$root/commands"
MXEON_BARE=$root unshare --mount --pid --fork --kill-child "$0" "$@" </dev/null
