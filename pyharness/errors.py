# SPDX-License-Identifier: Apache-2.0
"""Errors a user can cause; every one prints as one clear line, never as a traceback."""


class HarnessError(Exception):
    """Base class of all errors of the package."""


class DpFileError(HarnessError):
    """A data product file cannot be used at all."""


class PlannerLoadError(HarnessError):
    """A planner cannot be found or is not one."""


class OutputError(HarnessError):
    """A result cannot be written where it was asked for."""


class RerunError(HarnessError):
    """Recorded inputs cannot be run again."""
