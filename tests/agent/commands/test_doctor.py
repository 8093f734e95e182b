"""The doctor looks and reports; it changes nothing and does not import what it looks for."""

from __future__ import annotations

import sys

import pytest

from scenewright.agent import doctor
from scenewright.gaussians.language import encoders, masks


def test_every_finding_is_usable_or_says_what_to_do(findings: tuple[doctor.Finding, ...]) -> None:
    assert {"torch", "cuda", "embedded encoder", "torchvision", "ffmpeg"} <= {f.name for f in findings}
    assert all(f.usable != bool(f.fix) for f in findings)
    assert len({f.name for f in findings}) == len(findings)


def test_every_encoder_and_source_of_masks_is_told_of(findings: tuple[doctor.Finding, ...]) -> None:
    told = " ".join(f"{f.name} {f.serves}" for f in findings)
    assert all(name in told for name in encoders.names())
    assert all(name in told for name in masks.names())


def test_a_missing_package_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(doctor, "_version", lambda name: "")
    findings = {f.name: f for f in doctor.examine()}
    assert not findings["torch"].usable and findings["torch"].needed and findings["torch"].fix
    assert findings["torchvision"].detail == "not installed"
    assert all("models" in findings[name].fix for name in ("onnx:FOLDER", "masks sam:PATH"))


@pytest.mark.parametrize(
    ("version", "device", "nvcc", "usable", "told"),
    [("", True, "nvcc", False, "scenewright[cuda]"), ("1.5.3", False, "nvcc", False, "no CUDA device"),
     ("1.5.3", True, None, False, "no nvcc"), ("1.5.3", True, "/bin/nvcc", True, "/bin/nvcc"),
     ("1.5.3+pt24cu124", True, None, True, "compiled")],
)  # fmt: skip
def test_gsplat_needs_a_device_and_a_compiler(
    monkeypatch: pytest.MonkeyPatch, version: str, device: bool, nvcc: str | None, usable: bool, told: str
) -> None:
    cuda = doctor.Finding("cuda", "", device, False, "", "", "")
    monkeypatch.setattr(doctor, "_version", lambda name: version)
    monkeypatch.setattr(doctor, "_cuda", lambda: cuda)
    monkeypatch.setattr(doctor.shutil, "which", lambda name, path=None: nvcc)
    found = doctor._gsplat()
    assert found.usable is usable and told in f"{found.detail} {found.fix}" and found.usable != bool(found.fix)


def test_a_cpu_torch_is_not_asked_for_cuda(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(doctor, "_version", lambda name: "2.13.0+cpu")
    assert doctor._cuda().detail == "this torch is a CPU build"


@pytest.mark.parametrize(
    ("outcome", "usable", "told"),
    [(("", ""), True, "imports beside"), (("repaired", ""), True, "repairs"), (("", "broken"), False, "broken")],
)
def test_the_torchvision_trap(
    monkeypatch: pytest.MonkeyPatch, outcome: tuple[str, str], usable: bool, told: str
) -> None:
    monkeypatch.setattr(doctor, "_version", lambda name: {"torch": "2.13.0+cpu"}.get(name, "0.28.0"))
    monkeypatch.setattr(doctor, "_interpreter", lambda code: outcome)
    finding = doctor._torchvision()
    assert finding.usable is usable and told in finding.detail


def test_a_failing_import_is_quoted() -> None:
    assert doctor._interpreter("import sys; print('good')") == ("good", "")
    assert "No module named 'no_such_module'" in doctor._interpreter("import no_such_module")[1]


def test_the_machine() -> None:
    assert doctor.machine()["executable"] == sys.executable


@pytest.mark.usefixtures("torchvision_examined")
def test_every_planner_is_told_of_and_no_key_is_shown(monkeypatch: pytest.MonkeyPatch) -> None:
    for name in (doctor.ANY_KEY, *(key for _, _, keys in doctor.PLANNERS.values() for key in keys)):
        monkeypatch.delenv(name, raising=False)
    monkeypatch.setenv("ANTHROPIC_API_KEY", "sk-ant-very-secret-0123456789abcdef")
    monkeypatch.setenv("SCENEWRIGHT_MODEL", "openai:m@https://user:hunter2@example.org/v1")
    found = {f.name: f for f in doctor.examine()}
    assert found["anthropic:MODEL"].usable and "key in ANTHROPIC_API_KEY" in found["anthropic:MODEL"].detail
    assert not found["google:MODEL"].usable and "GOOGLE_API_KEY" in found["google:MODEL"].fix
    assert found["openai:MODEL"].usable and "only servers of your own" in found["openai:MODEL"].detail
    assert found["SCENEWRIGHT_MODEL"].detail == "openai:m@https://example.org/v1"
    told = " ".join(str(f.to_json()) for f in found.values())
    assert "secret" not in told and "hunter2" not in told


def test_the_doctors_table_of_planners_is_that_of_the_planners(findings: tuple[doctor.Finding, ...]) -> None:
    from scenewright.planners.model import FORMS
    from scenewright.planners.model.remote.address import OVERRIDE, SERVICES

    assert OVERRIDE == doctor.ANY_KEY
    assert {kind: (s.label, s.keys) for kind, s in SERVICES.items()} == {
        kind: (label, keys) for kind, (label, _, keys) in doctor.PLANNERS.items()
    }
    named = {f.name.partition(":")[0] for f in findings if f.serves.startswith("plans by")}
    assert named == {form.partition(":")[0] for form in FORMS}


@pytest.mark.usefixtures("torchvision_examined")
@pytest.mark.parametrize(
    ("name", "asked", "needed"),
    [("zstandard", "scenewright.agent.doctor._version", True), ("webp", "PIL.features.check", False)],
)
def test_libraries_of_file_formats_are_told_of(
    monkeypatch: pytest.MonkeyPatch, name: str, asked: str, needed: bool
) -> None:
    def found() -> doctor.Finding:
        return next(finding for finding in doctor.examine() if finding.name == name)

    before = found()
    monkeypatch.setattr(asked, lambda library: None)
    without = found()
    assert before.needed == needed and before.usable == (before.fix == "")
    assert not without.usable and without.fix
