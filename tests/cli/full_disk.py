"""`rex` on a disk that is full."""

import subprocess
import sys


def rex_with_files_up_to(most_bytes: int, *arguments: str) -> "subprocess.CompletedProcess[str]":
    """Run `rex` on a disk that is full for every file of so many bytes."""
    script = (
        f"import resource, sys; resource.setrlimit(resource.RLIMIT_FSIZE, ({most_bytes}, {most_bytes}))\n"
        "from reasoned_explorer.cli import main; sys.argv = ['rex', *sys.argv[1:]]; main()"
    )
    return subprocess.run([sys.executable, "-c", script, *arguments], capture_output=True, text=True, check=False)
