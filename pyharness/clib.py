# SPDX-License-Identifier: Apache-2.0
"""The only seam to the compiled library: nothing else imports `_navlib`.

`lib` holds Navlib's functions, tables and integer macros, `ffi` its types. Both are made from the
public C headers when the package is built, so they cannot differ from the library.
"""

from _navlib import ffi, lib

__all__ = ["ffi", "lib"]
