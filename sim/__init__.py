# SPDX-License-Identifier: Apache-2.0
"""The world: terrain, kinematic rover, slip, cameras and localisation noise. See README.md."""
