"""Measure everything, print a table, and fail where a bound is missed."""

from __future__ import annotations

import sys

from tests.benchmarks import (
    certificate_speed,
    decentralised,
    first_design,
    montecarlo_speed,
    region_speed,
    robot_design,
    simulation_speed,
    six_joints,
    spatial_six_joints,
    start,
    thermal_search,
    thermal_speed,
    tree_speed,
)
from tests.benchmarks.measure import Figure


def main() -> int:
    measured: list[Figure] = []
    chosen = (
        start,
        first_design,
        six_joints,
        spatial_six_joints,
        tree_speed,
        region_speed,
        robot_design,
        decentralised,
        certificate_speed,
        simulation_speed,
        montecarlo_speed,
        thermal_speed,
        thermal_search,
    )
    for benchmark in chosen:
        for each in benchmark.figures():
            measured.append(each)
            mark = "ok   " if each.holds else "FAILS"
            value = f"{each.value:.4g} {each.unit}".strip()
            bound = f"{each.relation} {each.bound:g} {each.unit}".strip()
            print(f"{mark}  {each.name:<40}  {value:>8}  {bound:<8}  {each.detail}", flush=True)
    return 0 if all(each.holds for each in measured) else 1


if __name__ == "__main__":
    sys.exit(main())
