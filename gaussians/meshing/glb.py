"""Writes a mesh as binary glTF 2.0 (.glb): one primitive, one material, the texture inside.

Khronos' "glTF 2.0 Specification": metres, y up, texture coordinates from the top-left corner, textures in sRGB, vertex
colours linear. The colours hold the light of the scene, so the material is unlit (KHR_materials_unlit); a program that
does not know the extension takes it as a rough, non-metallic one.
"""

from __future__ import annotations

import io
import json
import struct
from typing import Any

import numpy as np
from numpy.typing import NDArray

F64 = NDArray[np.float64]

_FLOAT, _UINT32, _UINT16 = 5126, 5125, 5123
_VERTICES, _INDICES = 34962, 34963  # buffer targets
_LINEAR, _MIPMAPS, _CLAMP = 9729, 9987, 33071  # filters and wrapping of a sampler


def encode(
    vertices: F64, faces: NDArray[np.int64], uv: F64 | None, texture: F64 | None, colors: F64 | None, name: str,
    two_sided: bool,
) -> bytes:  # fmt: skip
    """The bytes of a file.

    Args:
        vertices: `[V, 3]`, metres, y up.
        faces: `[F, 3]`, counter-clockwise seen from outside.
        uv, texture: `[V, 2]` from the top-left corner, and `[H, W, 3]` display colours, 0 to 1; or both None.
        colors: `[V, 3]` display colours, or None.
        name: of the mesh.
        two_sided: whether its inside is shown too.
    """
    chunks: list[bytes] = []
    made: dict[str, Any] = {
        "asset": {"version": "2.0", "generator": "scenewright"},
        "extensionsUsed": ["KHR_materials_unlit"],
        "scene": 0, "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0, "name": name}],
        "bufferViews": [], "accessors": [],
    }  # fmt: skip
    place = vertices.astype("<f4")
    attributes = {"POSITION": _add(made, chunks, place, "VEC3", _FLOAT, _VERTICES)}
    made["accessors"][0] |= {"min": place.min(axis=0).tolist(), "max": place.max(axis=0).tolist()}
    material: dict[str, Any] = {"metallicFactor": 0.0, "roughnessFactor": 1.0}
    if uv is not None and texture is not None:
        attributes["TEXCOORD_0"] = _add(made, chunks, uv.astype("<f4"), "VEC2", _FLOAT, _VERTICES)
        view = _view(made, chunks, _png(texture), None)
        made["images"] = [{"bufferView": view, "mimeType": "image/png", "name": name}]
        made["samplers"] = [{"magFilter": _LINEAR, "minFilter": _MIPMAPS, "wrapS": _CLAMP, "wrapT": _CLAMP}]
        made["textures"] = [{"source": 0, "sampler": 0}]
        material["baseColorTexture"] = {"index": 0}
    if colors is not None:
        of = np.column_stack([_linear(colors), np.ones(len(colors))])
        levels = (of * 65535 + 0.5).astype("<u2")
        attributes["COLOR_0"] = _add(made, chunks, levels, "VEC4", _UINT16, _VERTICES)
        made["accessors"][-1]["normalized"] = True
    indices = _add(made, chunks, faces.reshape(-1).astype("<u4"), "SCALAR", _UINT32, _INDICES)
    made["materials"] = [
        {"name": name, "pbrMetallicRoughness": material, "doubleSided": two_sided,
         "extensions": {"KHR_materials_unlit": {}}}
    ]  # fmt: skip
    made["meshes"] = [{"name": name, "primitives": [{"attributes": attributes, "indices": indices, "material": 0}]}]
    binary = b"".join(chunks)
    made["buffers"] = [{"byteLength": len(binary)}]
    text = json.dumps(made, separators=(",", ":")).encode()
    text += b" " * (-len(text) % 4)
    total = 12 + 8 + len(text) + 8 + len(binary)
    head = struct.pack("<4sII", b"glTF", 2, total) + struct.pack("<I4s", len(text), b"JSON")
    return head + text + struct.pack("<I4s", len(binary), b"BIN\0") + binary


def _add(made: dict[str, Any], chunks: list[bytes], data: NDArray[Any], kind: str, component: int, target: int) -> int:
    view = _view(made, chunks, data.tobytes(), target)
    made["accessors"].append({"bufferView": view, "componentType": component, "count": len(data), "type": kind})
    return len(made["accessors"]) - 1


def _view(made: dict[str, Any], chunks: list[bytes], data: bytes, target: int | None) -> int:
    start = sum(len(chunk) for chunk in chunks)
    chunks.append(data + b"\0" * (-len(data) % 4))
    view = {"buffer": 0, "byteOffset": start, "byteLength": len(data)}
    made["bufferViews"].append(view if target is None else view | {"target": target})
    return len(made["bufferViews"]) - 1


def _png(texture: F64) -> bytes:
    from PIL import Image

    file = io.BytesIO()
    Image.fromarray((texture * 255 + 0.5).astype(np.uint8)).save(file, "PNG")
    return file.getvalue()


def _linear(display: F64) -> F64:
    """sRGB to linear (IEC 61966-2-1)."""
    return np.where(display <= 0.04045, display / 12.92, ((display + 0.055) / 1.055) ** 2.4)
