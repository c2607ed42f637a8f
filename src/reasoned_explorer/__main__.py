"""``python -m reasoned_explorer`` is `rex`."""

from reasoned_explorer.cli import main

if __name__ == "__main__":
    main()
