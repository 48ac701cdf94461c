"""`python -m scaffold_cad.cli` is the command `scaffold-cad`."""

import sys

from scaffold_cad.cli import main

sys.exit(main())
