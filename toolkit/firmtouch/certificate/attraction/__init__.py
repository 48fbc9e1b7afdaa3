"""The region of attraction [T10]: a proof without sampling, and beside it what sampling finds."""

from firmtouch.certificate.attraction.attraction import (
    Attraction,
    NotProvenError,
    Search,
    Together,
    find_attraction,
    prove_attraction,
)
from firmtouch.certificate.attraction.chart import Chart, stiffness_chart
from firmtouch.certificate.attraction.joint_box import JointBox, find_joint_box
from firmtouch.certificate.attraction.proof import Limit
from firmtouch.certificate.attraction.speed import Speeds
from firmtouch.certificate.attraction.whole_box import WholeBox, find_whole_box, prove_whole_box

__all__ = [
    "Attraction",
    "Chart",
    "JointBox",
    "Limit",
    "NotProvenError",
    "Search",
    "Speeds",
    "Together",
    "WholeBox",
    "find_attraction",
    "find_joint_box",
    "find_whole_box",
    "prove_attraction",
    "prove_whole_box",
    "stiffness_chart",
]
