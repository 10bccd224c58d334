// SPDX-License-Identifier: MIT
// A component for Unity: turns arms and hands out of the body, each frame after the animation. It needs the package
// com.spherechain.runtime and an asset baked from the file that Unity imported. It has never run in Unity: the repository
// compiles and runs it against stubs.
using System.Collections.Generic;
using Spherechain;
using UnityEngine;

[DefaultExecutionOrder(-10)]  // before SelfCollision, which then shows the faults that are left
public sealed class SelfCollisionResponse : MonoBehaviour
{
    [Tooltip("The file that `spherechain bake` wrote, renamed to NAME.sphc.bytes")]
    public TextAsset asset;
    [Tooltip("All skinned meshes of the character; none: those below this object")]
    public SkinnedMeshRenderer[] renderers;
    [Tooltip("The axis that the importer turned around; X for Unity's FBX importer, glTFast, UnityGLTF and UniVRM")]
    public Axis mirroredAxis = Axis.X;
    [Tooltip("Length of a unit of the source file here: 0.01 where the file is in centimetres and the importer made metres of them")]
    public float sourceUnit = 1;
    [Range(0, 1), Tooltip("0: the full response; 1: none")]
    public float weakness;

    /// <summary>How many joints the last frame turned.</summary>
    public int Turned { get; private set; }

    Model model;  // characters of one asset can share it
    Body body;
    Response response;
    readonly ResponseState state = new ResponseState();
    Transform[] bones;  // those of the meshes and all above them, up to this object
    JointTransform[] joints;
    Quaternion[] animated, corrected;  // of the last frame

    void OnEnable()
    {
        try
        {
            Bind();
        }
        catch (SpherechainException error)
        {
            Debug.LogError("SelfCollisionResponse: " + error.Message, this);  // names the bone, and what differs
            enabled = false;
        }
    }

    void OnDisable()
    {
        if (response != null) response.Dispose();
        if (body != null) body.Dispose();
        if (model != null) model.Dispose();
        response = null;
        body = null;
        model = null;
    }

    /// <summary>Call it where the animation cuts, or the character is moved elsewhere.</summary>
    public void Forget() { state.Reset(); }

    void Bind()
    {
        if (renderers == null || renderers.Length == 0) renderers = GetComponentsInChildren<SkinnedMeshRenderer>();
        List<Transform> found = new List<Transform>();
        List<Matrix4x4> binds = new List<Matrix4x4>();
        foreach (SkinnedMeshRenderer renderer in renderers)
        {
            Transform[] own = renderer.bones;  // a copy, made anew at each call, as bindposes are
            Matrix4x4[] bindposes = renderer.sharedMesh.bindposes;
            for (int i = 0; i < own.Length; ++i)
            {
                if (found.Contains(own[i])) continue;
                found.Add(own[i]);
                binds.Add(bindposes[i]);
            }
        }
        for (int i = 0; i < found.Count; ++i)
        {
            Transform above = found[i].parent;
            if (above == null || above == transform || found.Contains(above)) continue;
            found.Add(above);  // no vertex follows it, so its matrix is not compared
            binds.Add(new Matrix4x4());
        }
        bones = found.ToArray();
        string[] names = new string[bones.Length];
        float[] inverseBinds = new float[16 * bones.Length];
        uint[] parents = new uint[bones.Length];
        for (int i = 0; i < bones.Length; ++i)
        {
            names[i] = bones[i].name;
            ToSource(binds[i], inverseBinds, 16 * i);
            int above = found.IndexOf(bones[i].parent);
            parents[i] = above < 0 ? Native.NoJoint : (uint)above;
        }
        model = new Model(asset.bytes, names, inverseBinds, MatrixLayout.Columns4x4);
        body = new Body(model);
        response = new Response(body, parents);
        joints = new JointTransform[bones.Length];
        animated = new Quaternion[bones.Length];
        corrected = new Quaternion[bones.Length];
        state.Reset();
    }

    void LateUpdate()
    {
        for (int i = 0; i < bones.Length; ++i)
        {
            // A joint that nobody animated since still has the correction: the response starts from the animation.
            Quaternion now = bones[i].localRotation;
            if (!IsSame(now, corrected[i])) animated[i] = now;
            joints[i] = ToSource(bones[i].localPosition, animated[i], bones[i].localScale);
        }
        ResponseFrame frame = new ResponseFrame { Seconds = Time.deltaTime, Weakness = weakness };
        response.Respond(state, joints, ref frame);
        Turned = frame.Turned;
        for (int i = 0; i < bones.Length; ++i)
        {
            JointTransform before = ToSource(bones[i].localPosition, animated[i], bones[i].localScale);
            corrected[i] = IsSame(before, joints[i]) ? animated[i] : ToEngine(joints[i]);
            if (!IsSame(bones[i].localRotation, corrected[i])) bones[i].localRotation = corrected[i];
            corrected[i] = bones[i].localRotation;  // as Unity keeps it
        }
    }

    // A mirror of one axis keeps that component of a rotation's axis and turns the others.
    Quaternion Mirrored(float x, float y, float z, float w)
    {
        return new Quaternion(mirroredAxis == Axis.X || mirroredAxis == Axis.None ? x : -x,
                              mirroredAxis == Axis.Y || mirroredAxis == Axis.None ? y : -y,
                              mirroredAxis == Axis.Z || mirroredAxis == Axis.None ? z : -z, w);
    }

    JointTransform ToSource(Vector3 position, Quaternion rotation, Vector3 scale)
    {
        Quaternion q = Mirrored(rotation.x, rotation.y, rotation.z, rotation.w);
        JointTransform joint = new JointTransform();
        joint.Translation.X = position.x;
        joint.Translation.Y = position.y;
        joint.Translation.Z = position.z;
        joint.Translation = Mirror.PointToEngine(joint.Translation, mirroredAxis, 1 / sourceUnit);
        joint.Rotation0 = q.x;
        joint.Rotation1 = q.y;
        joint.Rotation2 = q.z;
        joint.Rotation3 = q.w;
        joint.Scale.X = scale.x;
        joint.Scale.Y = scale.y;
        joint.Scale.Z = scale.z;
        return joint;
    }

    Quaternion ToEngine(JointTransform joint)
    {
        return Mirrored(joint.Rotation0, joint.Rotation1, joint.Rotation2, joint.Rotation3);
    }

    void ToSource(Matrix4x4 m, float[] to, int at)
    {
        to[at + 0] = m.m00; to[at + 1] = m.m10; to[at + 2] = m.m20; to[at + 3] = m.m30;
        to[at + 4] = m.m01; to[at + 5] = m.m11; to[at + 6] = m.m21; to[at + 7] = m.m31;
        to[at + 8] = m.m02; to[at + 9] = m.m12; to[at + 10] = m.m22; to[at + 11] = m.m32;
        to[at + 12] = m.m03; to[at + 13] = m.m13; to[at + 14] = m.m23; to[at + 15] = m.m33;
        Mirror.ToSource(to, at, mirroredAxis, sourceUnit);
    }

    static bool IsSame(Quaternion a, Quaternion b) { return a.x == b.x && a.y == b.y && a.z == b.z && a.w == b.w; }

    static bool IsSame(JointTransform a, JointTransform b)
    {
        return a.Rotation0 == b.Rotation0 && a.Rotation1 == b.Rotation1 && a.Rotation2 == b.Rotation2 && a.Rotation3 == b.Rotation3;
    }
}
