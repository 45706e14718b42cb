# Sourced by scripts/run and scripts/test: what is built runs on this computer.
# The workspace builds for x86-64-v3 (.cargo/config.toml); an older processor needs less.
if [ -z "${RUSTFLAGS+set}" ] && [ "$(uname -m)" = x86_64 ]; then
    for feature in avx2 bmi1 bmi2 f16c fma movbe abm; do
        if ! grep -qw "$feature" /proc/cpuinfo; then
            echo "this processor has no $feature: building for the oldest x86-64, which is slower" >&2
            export RUSTFLAGS="-C target-cpu=x86-64"
            break
        fi
    done
fi
