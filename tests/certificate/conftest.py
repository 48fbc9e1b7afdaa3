"""Subjects of shipped models and of mechanisms made for a test."""

import functools
from collections.abc import Callable
from pathlib import Path

import pytest

import firmtouch
from firmtouch.certificate.certificate import Certificate, certify
from firmtouch.certificate.subject import Subject, subject_of

MODELS = Path(__file__).parents[2] / "models"


def walk(model: firmtouch.ModelFile) -> Subject:
    op = firmtouch.find_operating_point(firmtouch.derive_plant(model.spec))
    return subject_of(op, firmtouch.assign_poles(op, model.spec.design).gains)


@functools.cache
def _shipped(name: str) -> Subject:
    return walk(firmtouch.read_model(MODELS / f"{name}.yaml").with_method("poles"))


@functools.cache
def _certified(name: str) -> Certificate:
    return certify(_shipped(name))


@pytest.fixture(scope="session")
def subject(model) -> Subject:
    """Poles assigned, for each shipped model."""
    return _shipped(model.name)


@pytest.fixture(scope="session")
def certificate(model) -> Certificate:
    return _certified(model.name)


@pytest.fixture(scope="session")
def subject_by_poles() -> Callable[[firmtouch.ModelFile], Subject]:
    """Walk from a model to its subject."""
    return walk
