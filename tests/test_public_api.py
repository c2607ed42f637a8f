import subprocess
import sys

import reasoned_explorer as rex


def test_every_public_name_can_be_loaded_and_has_a_docstring() -> None:
    for name in rex.__all__:
        assert getattr(rex, name).__doc__, name


def test_the_lazy_names_are_the_public_ones() -> None:
    assert sorted(rex._HOMES) == sorted(rex.__all__)


def test_importing_the_package_loads_nothing_heavy() -> None:
    heavy = ("numpy", "numba", "shapely", "matplotlib", "pydantic")
    code = f"import reasoned_explorer, sys; print([m for m in {heavy} if m in sys.modules])"
    shown = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert shown.stdout.strip() == "[]"


def test_the_help_of_the_command_line_loads_nothing_heavy() -> None:
    code = (
        "import sys\nsys.argv = ['rex', '--help']\nfrom reasoned_explorer.cli import main\n"
        "try:\n    main()\nexcept SystemExit:\n    pass\n"
        "print([m for m in ('numpy', 'numba', 'shapely', 'matplotlib') if m in sys.modules])"
    )
    shown = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert shown.stdout.strip().endswith("[]")
