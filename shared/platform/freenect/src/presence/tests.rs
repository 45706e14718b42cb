use super::*;

/// Kernel table and nodes with the given products of vendor 045e.
fn machine(products: &[&str]) -> tempfile::TempDir {
    let root = tempfile::tempdir().unwrap();
    fs::create_dir_all(root.path().join("table")).unwrap();
    fs::create_dir_all(root.path().join("nodes/001")).unwrap();
    for (index, product) in products.iter().enumerate() {
        let entry = root.path().join(format!("table/1-{index}"));
        fs::create_dir(&entry).unwrap();
        let device = (index + 1).to_string();
        for (name, text) in [
            ("idVendor", "045e"),
            ("idProduct", product),
            ("busnum", "1"),
            ("devnum", &device),
        ] {
            fs::write(entry.join(name), format!("{text}\n")).unwrap();
        }
        fs::write(root.path().join(format!("nodes/001/{:03}", index + 1)), "").unwrap();
    }
    root
}

fn scan(root: &Path) -> Presence {
    Presence::scan_in(&root.join("table"), &root.join("nodes"))
}

#[test]
fn each_state_of_a_machine_has_its_sentence() {
    for (products, usable, part) in [
        (
            vec!["02ae", "02b0", "02ad"],
            true,
            "1 Kinect camera(s) on USB",
        ),
        (vec!["02bf"], true, "1 Kinect camera(s) on USB"),
        (vec!["02b0"], false, "power supply"),
        (vec![], false, "no Kinect on USB"),
        (vec!["02c4"], false, "Kinect v1"),
        (vec!["0745"], false, "no Kinect on USB"),
    ] {
        let root = machine(&products);
        let presence = scan(root.path());
        assert_eq!(presence.is_usable(), usable, "{products:?}");
        assert!(presence.to_string().contains(part), "{presence}");
    }
}

#[test]
fn parts_have_their_node() {
    let root = machine(&["02ae", "02b0"]);
    let presence = scan(root.path());
    let kinds: Vec<_> = presence.parts().iter().map(|part| part.kind).collect();
    assert_eq!(kinds, [UsbPartKind::Camera, UsbPartKind::Motor]);
    assert_eq!(presence.parts()[1].node, root.path().join("nodes/001/002"));
}

#[test]
fn a_camera_without_its_node_can_not_be_used() {
    let root = machine(&["02ae"]);
    fs::remove_file(root.path().join("nodes/001/001")).unwrap();
    let presence = scan(root.path());
    assert!(!presence.is_usable());
    assert!(
        presence.to_string().contains("cannot be opened"),
        "{presence}"
    );
}

#[test]
fn missing_rights_name_the_udev_group() {
    let part = UsbPart {
        kind: UsbPartKind::Camera,
        product: 0x02ae,
        node: PathBuf::from("/dev/bus/usb/001/007"),
        access: Access::Denied,
    };
    let sentence = rights_sentence(&part).unwrap();
    for expected in ["/dev/bus/usb/001/007", "plugdev", "045e:02ae"] {
        assert!(sentence.contains(expected), "{sentence}");
    }
    assert_eq!(
        rights_sentence(&UsbPart {
            kind: UsbPartKind::Audio,
            ..part
        }),
        None
    );
}

#[test]
fn missing_bus_and_malformed_entries_are_tolerated() {
    let presence = Presence::scan_in(Path::new("/nonexistent"), Path::new("/nonexistent"));
    assert!(presence.to_string().contains("not visible"), "{presence}");
    let root = machine(&["02ae"]);
    fs::write(root.path().join("table/1-0/busnum"), "many").unwrap();
    fs::write(root.path().join("table/stray"), "").unwrap();
    assert!(scan(root.path()).parts().is_empty());
}
