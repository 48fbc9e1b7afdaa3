"""The reports that the repository keeps are those that it makes."""

import json
from pathlib import Path

import numpy as np
import pytest

import firmtouch
from firmtouch.certificate.file import read_certificate
from firmtouch.certificate.verify import verify
from firmtouch.report import design_as_json, study_as_json
from firmtouch.thermal.sensorfile import read_sensor
from firmtouch.thermal.study import study_sensor

ROOT = Path(__file__).parents[2]


@pytest.mark.parametrize("name", ["planar_2r_wall", "two_arms_bar"])
def test_a_kept_sample_is_the_design_of_its_model(name):
    kept = json.loads((ROOT / "reports" / "samples" / name / "design.json").read_text(encoding="utf-8"))
    made = design_as_json(firmtouch.design_model(firmtouch.read_model(ROOT / "models" / f"{name}.yaml")))
    assert kept["model"] == made["model"]
    for key, value in made["operating_point"].items():
        # Newton's method ends at rounding; another machine's BLAS may round otherwise.
        np.testing.assert_allclose(kept["operating_point"][key], value, atol=1e-9)
    for key, value in made["gains"].items():
        # The mode shapes come from a minimisation, which stops where the norm of W changes by less than 1e-5 of it.
        np.testing.assert_allclose(kept["gains"][key], value, atol=1e-3 * np.abs(np.array(value)).max())


@pytest.mark.parametrize("name", ["planar_2r_wall", "two_arms_bar"])
def test_a_kept_sample_is_whole(name):
    folder = ROOT / "reports" / "samples" / name
    assert (folder / "report.html").read_text(encoding="utf-8").rstrip().endswith("</html>")
    assert (folder / "report.pdf").read_bytes().rstrip().endswith(b"%%EOF")


def test_a_kept_certificate_is_proven_again():
    """The small one: the other's region of attraction takes long."""
    folder = ROOT / "reports" / "samples" / "planar_2r_wall"
    file = read_certificate((folder / "certificate.json").read_bytes(), "certificate.json")
    model = firmtouch.read_model(ROOT / "models" / "planar_2r_wall.yaml")
    found = verify(file, model, (folder / "design.json").read_bytes())
    assert found.holds, found.differences


def test_the_kept_sensor_is_what_its_report_says():
    """The sensor that the search found, analysed once more from the file that was written of it."""
    folder = ROOT / "reports" / "samples" / "fingertip_film"
    kept = json.loads((folder / "thermal.json").read_text(encoding="utf-8"))
    source = (ROOT / "models" / "thermal" / "fingertip_film.yaml").read_text(encoding="utf-8")
    assert kept["file"]["source"] == source
    assert kept["verdict"] == "met"
    made = study_as_json(study_sensor(read_sensor(folder / "sensor.yaml")))
    assert made["verdict"] == "met"
    for key in ("object", "contact", "drive"):
        assert [each[key] for each in kept["responses"]] == [each[key] for each in made["responses"]]
    for key in ("rise_time_10_90", "rise_time_63", "end_value", "gain"):
        found = [[each[key] for each in of["responses"]] for of in (kept, made)]
        np.testing.assert_allclose(*found, rtol=1e-4)  # sizes are written with six figures
    assert (folder / "report.html").read_text(encoding="utf-8").rstrip().endswith("</html>")
    assert (folder / "report.pdf").read_bytes().rstrip().endswith(b"%%EOF")
