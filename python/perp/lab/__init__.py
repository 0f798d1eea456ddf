# SPDX-License-Identifier: Apache-2.0
"""The laboratory: methods compared on many problems, by the program perp, each run in a process of its own.

perp-compare (or `python3 -m perp.lab compare`) runs a campaign, perp-report makes its report again and joins shards.
It needs the program perp, matplotlib and jinja2, and nothing of the rest of this package.
"""
