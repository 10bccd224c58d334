// SPDX-License-Identifier: MIT
// A component for Unity: which body parts of a character are inside each other, each frame after the animation. Select the
// character to see it. Needs runtime/csharp, the library, and an asset baked from the file that Unity imported: docs/csharp.md.
// It has never run in Unity: the repository compiles and runs it against stubs.
using Spherechain;
using UnityEngine;

public sealed class SelfCollision : MonoBehaviour
{
    [Tooltip("The file that `spherechain bake` wrote, renamed to NAME.sphc.bytes")]
    public TextAsset asset;
    [Tooltip("All skinned meshes of the character; none: those below this object")]
    public SkinnedMeshRenderer[] renderers;
    [Tooltip("The axis that the importer turned around; X for Unity's FBX importer, glTFast, UnityGLTF and UniVRM")]
    public Axis mirroredAxis = Axis.X;
    [Tooltip("Length of a unit of the source file here: 0.01 where the file is in centimetres and the importer made metres of them")]
    public float sourceUnit = 1;
    [Tooltip("Keep the way out of the last frame while it is nearly the shortest, so that it does not flicker")]
    public bool keepsDirections = true;

    /// <summary>The last frame's, the worst first; null while disabled. Its positions are the source's: see Position() and
    /// Direction().</summary>
    public Results<Penetration> Penetrations { get; private set; }
    public string PartName(uint part) { return model.PartName(part); }

    Model model;  // characters of one asset can share it
    Body body;
    Transform[] bones;
    Matrix4x4[] bindposes;
    float[] palette;

    void OnEnable()
    {
        try
        {
            Bind();
        }
        catch (SpherechainException error)
        {
            Debug.LogError("SelfCollision: " + error.Message, this);  // names the bone, and what differs
            enabled = false;
        }
    }

    void OnDisable()
    {
        Penetrations = null;
        if (body != null) body.Dispose();
        if (model != null) model.Dispose();
        body = null;
        model = null;
    }

    // Once: `bones` and `bindposes` of a renderer are copies, made anew at each call.
    void Bind()
    {
        if (renderers == null || renderers.Length == 0) renderers = GetComponentsInChildren<SkinnedMeshRenderer>();
        int count = 0;
        foreach (SkinnedMeshRenderer renderer in renderers) count += renderer.bones.Length;
        bones = new Transform[count];
        bindposes = new Matrix4x4[count];
        count = 0;
        foreach (SkinnedMeshRenderer renderer in renderers)
        {
            renderer.bones.CopyTo(bones, count);
            renderer.sharedMesh.bindposes.CopyTo(bindposes, count);
            count += renderer.bones.Length;
        }
        string[] names = new string[count];
        float[] inverseBinds = new float[16 * count];
        palette = new float[16 * count];
        for (int i = 0; i < count; ++i)
        {
            names[i] = bones[i].name;
            ToSource(bindposes[i], inverseBinds, 16 * i);
        }
        model = new Model(asset.bytes, names, inverseBinds, MatrixLayout.Columns4x4);
        body = new Body(model);
    }

    void LateUpdate()
    {
        FillPalette();
        body.SetPose(palette, MatrixLayout.Columns4x4);
        // Folds at joints and touches, too.
        Penetrations = body.Penetrations(new Query { Classes = Query.AllClasses, Previous = keepsDirections ? Penetrations : null });
    }

    // World times bind pose, as a skinning shader has it, but in this object's space: its place and scale do not matter.
    void FillPalette()
    {
        Matrix4x4 toCharacter = transform.worldToLocalMatrix;
        for (int i = 0; i < bones.Length; ++i)
        {
            ToSource(toCharacter * bones[i].localToWorldMatrix * bindposes[i], palette, 16 * i);
        }
    }

    void ToSource(Matrix4x4 m, float[] to, int at)
    {
        to[at + 0] = m.m00; to[at + 1] = m.m10; to[at + 2] = m.m20; to[at + 3] = m.m30;
        to[at + 4] = m.m01; to[at + 5] = m.m11; to[at + 6] = m.m21; to[at + 7] = m.m31;
        to[at + 8] = m.m02; to[at + 9] = m.m12; to[at + 10] = m.m22; to[at + 11] = m.m32;
        to[at + 12] = m.m03; to[at + 13] = m.m13; to[at + 14] = m.m23; to[at + 15] = m.m33;
        Mirror.ToSource(to, at, mirroredAxis, sourceUnit);
    }

    /// <summary>A point of a result in this object's space.</summary>
    public Vector3 Position(Vec3 p)
    {
        p = Mirror.PointToEngine(p, mirroredAxis, sourceUnit);
        return new Vector3(p.X, p.Y, p.Z);
    }

    /// <summary>The way that the part must go, in this object's space, and how far.</summary>
    public Vector3 Direction(Penetration found)
    {
        Vec3 d = Mirror.DirectionToEngine(found.Direction, mirroredAxis);
        float length = found.Distance * sourceUnit;
        return new Vector3(d.X * length, d.Y * length, d.Z * length);
    }

    [ContextMenu("Check the bind pose")]  // while the character stands in it, off the origin and turned
    public void CheckBindPose()
    {
        FillPalette();
        try
        {
            model.CheckRest(palette, MatrixLayout.Columns4x4);
            Debug.Log("SelfCollision: the matrices fit", this);
        }
        catch (SpherechainException error)
        {
            Debug.LogError("SelfCollision: " + error.Message, this);
        }
    }

    void OnDrawGizmosSelected()
    {
        if (Penetrations == null) return;
        Gizmos.matrix = transform.localToWorldMatrix;
        foreach (Penetration found in Penetrations)
        {
            // From DeepFold on it is a fault; folds at joints and touches are small and green.
            bool isFault = found.Kind >= PenetrationClass.DeepFold;
            Gizmos.color = isFault ? Color.red : Color.green;
            Vector3 from = Position(found.Deepest.Position);
            Gizmos.DrawSphere(from, sourceUnit * model.Height * (isFault ? 0.01f : 0.004f));
            Gizmos.DrawLine(from, from + Direction(found));
        }
    }
}
