"""Checks of the Xcode project's content: every reference leads somewhere, on disk as in the file."""

import json
import pathlib
import plistlib
import sys
import xml.etree.ElementTree

import openstep_plist

FAULTS: list[str] = []


def expect(condition: bool, fault: str) -> None:
    if not condition:
        FAULTS.append(fault)


def references(value: object):
    """Every string in an object that looks like an identifier."""
    if isinstance(value, dict):
        for item in value.values():
            yield from references(item)
    elif isinstance(value, (list, tuple)):
        for item in value:
            yield from references(item)
    elif isinstance(value, str) and len(value) == 24 and value.startswith("7A00"):
        yield value


def check_project(path: pathlib.Path) -> dict:
    folder = path.parent.parent
    project = openstep_plist.loads(path.read_text(encoding="utf-8"))
    objects = project["objects"]
    expect(str(project["objectVersion"]) == "77", "objectVersion: expected 77")
    for identifier, body in objects.items():
        for reference in references(body):
            expect(reference in objects, f"{identifier}: refers to {reference}, which is not there")
    used = set(references(project))
    for identifier, body in objects.items():
        expect(identifier in used, f"{identifier} ({body['isa']}): nothing refers to it")

    def kind(isa: str) -> list[dict]:
        return [body for body in objects.values() if body["isa"] == isa]

    for group in kind("PBXFileSystemSynchronizedRootGroup"):
        place = folder / group["path"]
        expect(place.is_dir(), f"synchronised folder {place}: expected a folder")
        for exception in group.get("exceptions", []):
            for name in objects[exception]["membershipExceptions"]:
                expect((place / name).is_file(), f"exception {place / name}: expected a file")
    packages = [folder / body["relativePath"] for body in kind("XCLocalSwiftPackageReference")]
    manifests = ""
    for package in packages:
        manifest = package / "Package.swift"
        expect(manifest.is_file(), f"package {package}: expected Package.swift")
        manifests += manifest.read_text(encoding="utf-8") if manifest.is_file() else ""
    for product in kind("XCSwiftPackageProductDependency"):
        declared = f'.library(name: "{product["productName"]}"' in manifests
        expect(declared, f"product {product['productName']}: expected it in a package")
    for reference in kind("PBXFileReference"):
        if reference["sourceTree"] == "<group>":
            place = folder / reference["path"]
            expect(place.exists(), f"file reference {place}: expected it to be there")
    for configuration in kind("XCBuildConfiguration"):
        settings = configuration["buildSettings"]
        for setting in ("INFOPLIST_FILE", "CODE_SIGN_ENTITLEMENTS"):
            if setting in settings:
                place = folder / settings[setting]
                expect(place.is_file(), f"{setting} {place}: expected a file")
    return {body["name"]: identifier for identifier, body in objects.items()
            if body["isa"] == "PBXNativeTarget"}


def check_scheme(path: pathlib.Path, targets: dict) -> None:
    for reference in xml.etree.ElementTree.parse(path).iter("BuildableReference"):
        name = reference.get("BlueprintName")
        expect(targets.get(name) == reference.get("BlueprintIdentifier"),
               f"{path.name}: {name} has another identifier than in the project")


def check_app(app: pathlib.Path) -> None:
    info = plistlib.loads((app / "Info.plist").read_bytes())
    for key in ("NSCameraUsageDescription", "CFBundleDocumentTypes", "UTImportedTypeDeclarations"):
        expect(bool(info.get(key)), f"Info.plist: expected {key}")
    expect(info.get("CADisableMinimumFrameDurationOnPhone") is True,
           "Info.plist: 120 Hz needs CADisableMinimumFrameDurationOnPhone")
    imported = {kind["UTTypeIdentifier"] for kind in info["UTImportedTypeDeclarations"]}
    for document in info["CFBundleDocumentTypes"]:
        for kind in document["LSItemContentTypes"]:
            expect(kind.startswith("public.") or kind in imported,
                   f"Info.plist: document type {kind} is declared nowhere")
    entitlements = plistlib.loads((app / "Trapeze.entitlements").read_bytes())
    for key in ("app-sandbox", "device.camera", "files.user-selected.read-write"):
        expect(entitlements.get(f"com.apple.security.{key}") is True, f"entitlements: expected {key}")
    privacy = plistlib.loads((app / "PrivacyInfo.xcprivacy").read_bytes())
    expect(privacy.get("NSPrivacyTracking") is False, "privacy manifest: expected no tracking")
    for reasons in privacy["NSPrivacyAccessedAPITypes"]:
        expect(bool(reasons["NSPrivacyAccessedAPITypeReasons"]), "privacy manifest: expected reasons")
    for contents in app.glob("Assets.xcassets/**/Contents.json"):
        for image in json.loads(contents.read_text(encoding="utf-8")).get("images", []):
            check_icon(contents.parent / image["filename"], image)


def check_icon(path: pathlib.Path, image: dict) -> None:
    header = path.read_bytes()[:26] if path.is_file() else b""
    side = float(image["size"].split("x")[0]) * float(image.get("scale", "1x")[:-1])
    width, height = (int.from_bytes(header[i : i + 4], "big") for i in (16, 20))
    expect(header[:8] == b"\x89PNG\r\n\x1a\n", f"{path}: expected a PNG")
    expect(width == height == side, f"{path}: expected {side:.0f} pixels, found {width} × {height}")
    # 2 is RGB: the store refuses icons with an alpha channel.
    expect(header[25:26] == b"\x02", f"{path}: expected no alpha channel")


def main() -> int:
    path = pathlib.Path(sys.argv[1])
    targets = check_project(path)
    for scheme in path.parent.glob("xcshareddata/xcschemes/*.xcscheme"):
        check_scheme(scheme, targets)
    check_app(path.parent.parent / "Trapeze")
    for fault in FAULTS:
        print(f"{path}: {fault}", file=sys.stderr)
    if not FAULTS:
        print("openstep-plist: every reference leads somewhere; Info.plist, entitlements, icons checked")
    return 1 if FAULTS else 0


if __name__ == "__main__":
    sys.exit(main())
