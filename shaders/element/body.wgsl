// The material of an element: that of its body.
fn material_of(case_index: u32, element: u32) -> Material {
    var index = case_index;
    if element >= dimensions.own_elements {
        index += dimensions.cases;
    }
    return load_material(index, dimensions.materials);
}
