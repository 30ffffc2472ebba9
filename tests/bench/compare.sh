#!/usr/bin/env bash
# Samples per CPU second of pts against a C++ program of the classic algorithm, on the scene of both, side by side:
# A B A B …, one thread each, so that whatever else the machine does disturbs both alike. Prints the ratio of each
# round, their median, and both image means, which must agree within 0.5 %.
#
#   tests/bench/compare.sh [bsdf|mis] [ROUNDS] [WIDTH] [HEIGHT] [SPP]
#
# bsdf: the same algorithm on both sides (light is found by hits only).
# mis:  light sampling on both sides (the C++ program with -DDIRECT).
set -euo pipefail
direct=${1:-bsdf} rounds=${2:-7} width=${3:-256} height=${4:-192} spp=${5:-64}
here=$(cd "$(dirname "$0")" && pwd)
root=$(cd "$here/../.." && pwd)
out=$root/target/bench
mkdir -p "$out"

flags=()
[ "$direct" = bsdf ] || flags=(-DDIRECT)
g++ -O3 -march=native "${flags[@]}" -o "$out/smallpt" "$here/smallpt.cpp"
cargo build --release --quiet --manifest-path "$root/Cargo.toml" --bin pts --example image_mean
pts=$root/target/release/pts

field() { sed -n "s/.*\"$1\": *\([0-9.]*\).*/\1/p"; }
samples=$((width * height * spp))
TIMEFORMAT='%U %S'

# User and system time of the whole process: loading and writing count against us.
ours() {
    { time "$pts" render "$root/scenes/cornell.pts" --filter box --nets 1 --direct "$direct" -j 1 --spp "$spp" \
        --width "$width" --height "$height" --seed "$1" -q --progress none -o "$out/pts.exr" 2>"$out/pts.log"; } 2>&1 |
        awk -v n="$samples" '{ printf "%.0f\n", n / ($1 + $2) }'
}

ratios=()
printf '%5s %14s %14s %7s\n' round pts/s c++/s ratio
for ((i = 1; i <= rounds; i++)); do
    a=$(ours "$i")
    line=$("$out/smallpt" "$width" "$height" "$spp")
    b=$(field samples_per_cpu_second <<<"$line")
    r=$(awk -v a="$a" -v b="$b" 'BEGIN { printf "%.3f", a / b }')
    ratios+=("$r")
    printf '%5d %14d %14d %7s\n' "$i" "$a" "$b" "$r"
done
median=$(printf '%s\n' "${ratios[@]}" | sort -n | awk '{ v[NR] = $1 } END { print v[int((NR + 1) / 2)] }')
echo "median ratio ($direct): $median"

ours_mean=$("$root/target/release/examples/image_mean" "$out/pts.exr" |
    sed 's/.* B=\([0-9.]*\).* G=\([0-9.]*\).* R=\([0-9.]*\).*/\1 \2 \3/' | awk '{ printf "%.5f", ($1 + $2 + $3) / 3 }')
theirs_mean=$(field mean <<<"$line")
echo "image mean: pts $ours_mean, c++ $theirs_mean ($(awk -v a="$ours_mean" -v b="$theirs_mean" \
    'BEGIN { printf "%+.2f %%", 100 * (a / b - 1) }'))"
