//! Which meshes the scene shows, and where.

use glam::{DMat4, DQuat, DVec3};
use gltf_json::{Index, Mesh, Node};

use super::document::Document;
use crate::error::Result;

/// A mesh with the transform to the scene.
pub(super) struct Placed {
    pub mesh: Index<Mesh>,
    pub world: DMat4,
    pub node: usize,
}

/// The meshes of the default scene, or the first one, or of all nodes that are no one's
/// children, in the order of a walk from the roots.
pub(super) fn placed_meshes(document: &Document) -> Result<Vec<Placed>> {
    let nodes = &document.root.nodes;
    // The last one is taken first, so roots and children are put on in reverse.
    let mut waiting: Vec<(usize, DMat4)> =
        roots(document)?.into_iter().rev().map(|root| (root, DMat4::IDENTITY)).collect();
    let mut reached = vec![false; nodes.len()];
    let mut placed = Vec::new();
    while let Some((n, parent)) = waiting.pop() {
        let Some(node) = nodes.get(n) else {
            let what = format!("node {n} does not exist; export the file again");
            return Err(document.source.at("nodes", what));
        };
        if std::mem::replace(&mut reached[n], true) {
            let what = "is reached twice: its ancestors form a cycle, or it has two parents, and nodes must \
                        form trees; export the file again";
            return Err(document.source.at(format!("nodes[{n}]"), what));
        }
        let world = parent * local(node);
        if let Some(mesh) = node.mesh {
            placed.push(Placed { mesh, world, node: n });
        }
        let children = node.children.iter().flatten();
        waiting.extend(children.rev().map(|child| (child.value(), world)));
    }
    Ok(placed)
}

fn roots(document: &Document) -> Result<Vec<usize>> {
    let root = &document.root;
    let scene = match root.scene {
        Some(index) => Some(document.get(index, "scene")?),
        None => root.scenes.first(),
    };
    if let Some(scene) = scene {
        return Ok(scene.nodes.iter().map(|node| node.value()).collect());
    }
    let mut is_child = vec![false; root.nodes.len()];
    for child in root.nodes.iter().flat_map(|node| node.children.iter().flatten()) {
        if let Some(mark) = is_child.get_mut(child.value()) {
            *mark = true;
        }
    }
    Ok((0..is_child.len()).filter(|&n| !is_child[n]).collect())
}

/// The transform of a node to its parent: a matrix, or translation, rotation and scale.
fn local(node: &Node) -> DMat4 {
    if let Some(columns) = node.matrix {
        return DMat4::from_cols_array(&columns.map(f64::from));
    }
    let vector = |values: [f32; 3]| DVec3::from_array(values.map(f64::from));
    let scale = node.scale.map_or(DVec3::ONE, vector);
    let translation = node.translation.map_or(DVec3::ZERO, vector);
    let stored = node.rotation.map_or(DQuat::IDENTITY, |q| DQuat::from_array(q.0.map(f64::from)));
    let rotation = if stored.length_squared() > 0.0 { stored.normalize() } else { DQuat::IDENTITY };
    DMat4::from_scale_rotation_translation(scale, rotation, translation)
}
