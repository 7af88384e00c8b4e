#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# Renews this folder from a clone of MaterialX: tests/materialx_main/renew.sh CLONE [RELEASE [COMMIT]]
set -eu
folder=$(dirname "$0") clone=$1 release=${2:-v1.39.5} commit=${3:-origin/main}
git -C "$clone" rev-parse --quiet --verify "$commit" >/dev/null || commit=HEAD
git -C "$clone" diff --full-index "$release" "$commit" -- libraries >"$folder/libraries.patch"
git -C "$clone" log --date=short --abbrev=9 --format='%h %cd %s' "$release..$commit" >"$folder/commits.txt"
