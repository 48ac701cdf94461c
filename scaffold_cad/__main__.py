"""`python -m scaffold_cad`: the command `scaffold-cad`."""

import sys

from scaffold_cad.cli import main

if __name__ == "__main__":
    sys.exit(main())
