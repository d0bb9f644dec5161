# Sourced by run.sh, docs.sh and test.sh, with $project set: brings the environment .venv up to date.
#
#   set_up KIND    KIND is run or test, or docs or quick (some of the tests), which need no ROS and so
#                  no compiler; returns at once if nothing has changed since the last set-up, otherwise
#                  chooses a Python and lets it run set_up.py, or says what is missing
#
# The package is installed editable: edits below src/, config/ and launch/ take effect at once, in
# .venv/bin/python as well, so a developer needs no other set-up than these scripts.

supported="3.10 to 3.13"

refuse() {
    echo "$1" >&2
    exit 1
}

# Another ROS (an installation under /opt, an overlay, another environment) sets library and module
# paths that would be mixed up with ours.
forget_other_ros() {
    if [[ -n "${AMENT_PREFIX_PATH:-}${_ROS_WHEELS_BOOTSTRAP_COMPLETE:-}" ]]; then
        unset LD_LIBRARY_PATH
    fi
    unset AMENT_PREFIX_PATH CMAKE_PREFIX_PATH COLCON_PREFIX_PATH _ROS_WHEELS_BOOTSTRAP_COMPLETE
    unset PYTHONPATH PYTHONHOME
}

# Of all the environment is made from; the folder is part of it, for .venv cannot be moved.
fingerprint() {
    (
        cd "$project"
        export LC_ALL=C
        {
            echo "$project"
            sha256sum requirements/* setup.py setup.cfg package.xml scripts/set_up.py
            find msg_defs -type f -exec sha256sum {} + | sort
            find src -name "*.c" -exec sha256sum {} + | sort
            find config launch -name "*.*" ! -name "*.pyc" | sort # each has a link
        } | sha256sum | cut -d " " -f 1
    )
}

is_up_to_date() { # KIND FINGERPRINT
    local folder="$project/.venv/.set_up"
    [[ -x "$project/.venv/bin/python" && -r "$folder/$1" && "$(<"$folder/$1")" == "$2" ]] || return 1
    [[ -z "${PYTHON:-}" || "$PYTHON" == "$(<"$folder/python")" ]]
}

check_machine() {
    local system library oldest
    system="$(uname -sm)"
    if [[ "$system" != "Linux x86_64" ]]; then
        refuse "This set-up needs Linux on x86-64, since ROS 2 comes as Python wheels for nothing\
 else, and this is $system: install ROS 2 Jazzy itself and build with colcon (see README.md)."
    fi
    library="$(getconf GNU_LIBC_VERSION 2>/dev/null || echo "no glibc")"
    oldest="$(printf '%s\n' "glibc 2.28" "$library" | sort -V | head -n 1)"
    if [[ "$library" != glibc* || "$oldest" != "glibc 2.28" ]]; then
        refuse "This set-up needs glibc 2.28 or newer (Debian 10, Ubuntu 20.04, RHEL 8), since ROS 2\
 comes as Python wheels for nothing else, and this system has $library: use a newer system."
    fi
}

is_supported() {
    "$1" -I -c "import sys; sys.exit(not (3, 10) <= sys.version_info[:2] <= (3, 13))" 2>/dev/null
}

# A distributor's Python is built with what running it has shown, and a tenth faster than one built
# without, as by default from source (pyenv).
is_optimised() {
    "$1" -I -c "import sys, sysconfig; sys.exit(not (sys.base_prefix == '/usr'
        or '--enable-optimizations' in (sysconfig.get_config_var('CONFIG_ARGS') or '')))"
}

# Sets $python to the first Python that has all that is needed; one that was not asked for and is not
# optimised only if no other is.
choose_python() { # KIND
    local name candidate candidates=() problem first_problem="" seen="" plain=""
    for name in python3 python3.13 python3.12 python3.11 python3.10; do
        while read -r candidate; do
            candidates+=("$candidate")
        done < <(type -aP "$name")
    done
    for candidate in ${PYTHON:+"$PYTHON"} "${candidates[@]}"; do
        if ! is_supported "$candidate"; then
            problem="$("$candidate" --version 2>&1 | head -n 1 || true)"
            if [[ "$candidate" == "${PYTHON:-}" ]]; then
                echo "PYTHON=$PYTHON is no Python $supported; looking for another one." >&2
            fi
            [[ "$problem" == "Python "* ]] && seen="$seen, $candidate is $problem"
            continue
        fi
        problem="$("$candidate" -I "$project/scripts/set_up.py" problem "$1")"
        if [[ -n "$problem" ]]; then
            first_problem="${first_problem:-$problem}"
        elif [[ "$candidate" == "${PYTHON:-}" ]] || is_optimised "$candidate"; then
            python="$candidate"
            if [[ -n "$plain" ]]; then
                echo "Taking $python: $plain is built without optimisation, which makes everything a\
 tenth slower (PYTHON=$plain takes it all the same)." >&2
            fi
            return
        else
            plain="${plain:-$candidate}"
        fi
    done
    python="$plain"
    [[ -n "$python" ]] || refuse "${first_problem:-No Python $supported was found${seen:+\
 (${seen#, })}: install one, e.g. with 'sudo apt install python3 python3-venv python3-dev', or name\
 one with PYTHON=/path/to/python.}"
}

set_up() { # KIND
    local wanted python
    forget_other_ros
    wanted="$(fingerprint)"
    if is_up_to_date "$1" "$wanted"; then
        return
    fi
    # The environment must not be made from itself, even if it is the active one.
    PATH=":$PATH:"
    PATH="${PATH//":$project/.venv/bin:"/:}"
    PATH="${PATH#:}"
    PATH="${PATH%:}"
    [[ "$1" == quick || "$1" == docs ]] || check_machine
    choose_python "$1"
    "$python" -I "$project/scripts/set_up.py" "$1" "$wanted" "${PYTHON:-}"
}
