# SPDX-License-Identifier: Apache-2.0
"""The harness: drives a planner through the simulated world, records it and looks at it."""
